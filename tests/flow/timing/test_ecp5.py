import pytest

from splatline.flow.timing.ecp5 import DEVICES, choose
from splatline.flow.tools import ToolError


@pytest.mark.parametrize(
    ("block_rams", "name"), [(17, "25F"), (56, "25F"), (57, "45F"), (65, "45F"), (109, "85F")]
)
def test_the_smallest_device_with_the_block_rams_is_taken(block_rams, name):
    assert choose(block_rams).name == f"LFE5U-{name}-6BG381"


def test_a_device_that_is_named_is_taken():
    assert choose(17, "LFE5U-85F") == DEVICES[-1]


@pytest.mark.parametrize(
    ("block_rams", "name", "told"),
    [
        (209, None, "the engine needs 209 block RAMs, and the largest ECP5 has 208"),
        (57, "LFE5U-25F", "the engine needs 57 block RAMs, and LFE5U-25F-6BG381 has 56"),
    ],
)
def test_what_does_not_fit_is_said(block_rams, name, told):
    with pytest.raises(ToolError, match=told):
        choose(block_rams, name)


def test_the_devices_have_the_block_rams_of_their_data_sheet():
    """FPGA-DS-02012: 56, 108 and 208 sysMEM blocks."""
    assert [device.block_rams for device in DEVICES] == [56, 108, 208]


def test_each_block_ram_has_a_site_of_its_own():
    for device in DEVICES:
        sites = {
            device.site(row, place)
            for row in range(len(device.rows))
            for place in range(device.row_length)
        }
        assert len(sites) == device.block_rams
    assert DEVICES[0].site(0, 0) == "X4/Y25/EBR0"
    assert DEVICES[0].site(1, 27) == "X66/Y37/EBR3"
