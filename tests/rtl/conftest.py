import os

import pytest

from splatline.sim.cosim import simulator

BOTH = os.environ.get("SPLATLINE_TEST_SIMULATORS") == "all"


def installed(name):
    if not simulator.available(name):
        pytest.skip(f"the simulator {name} is not installed")
    return name


@pytest.fixture(params=simulator.SIMULATORS)
def simulator_name(request):
    """Each simulator in turn; one that is not installed is skipped."""
    return installed(request.param)


@pytest.fixture(params=simulator.SIMULATORS if BOTH else ["the quicker"])
def block_simulator(request):
    """Icarus if it is there, as it builds a block in no time; SPLATLINE_TEST_SIMULATORS=all: both.

    Verilator and Icarus are compared where much is at stake: engines, decoder and window.
    """
    if BOTH:
        return installed(request.param)
    return "icarus" if simulator.available("icarus") else "verilator"
