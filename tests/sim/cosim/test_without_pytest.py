import pytest

from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import SimulationError
from tests.sim.cosim import pytest_bench


def test_a_simulator_loads_pytest_for_benches_with_checks_alone():
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    built = simulator.build({"dut.v": "module dut; endmodule"}, "dut", simulator=quickest)
    simulator.run(built, pytest_bench.__name__, checks=False)
    with pytest.raises(SimulationError, match="pytest is loaded"):
        simulator.run(built, pytest_bench.__name__)
