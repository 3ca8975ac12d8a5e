import pytest

from splatline.sim.cosim import simulator


@pytest.fixture(params=simulator.SIMULATORS)
def simulator_name(request):
    """Each simulator in turn; one that is not installed is skipped."""
    if not simulator.available(request.param):
        pytest.skip(f"the simulator {request.param} is not installed")
    return request.param
