"""Simple memories are block RAM in families without true dual port, and dual ones are not."""

from collections import Counter

import pytest

from splatline.contract.presets import PAPER, RGB24
from splatline.flow.area import families
from splatline.flow.area.families import FAMILY_FLOWS, count_family, count_memories, lanes_of
from splatline.flow.tools import ToolError
from splatline.flow.verilog import convert
from splatline.rtl.tiles.lane import Lane


@pytest.mark.parametrize(("family", "block_rams"), [("ice40", 3), ("cyclonev", 1)])
def test_a_lane_with_simple_memories_is_block_ram_and_one_with_dual_ones_is_not(family, block_rams):
    """512 pixels of 18 bits."""

    def count(memory):
        text = convert(Lane(PAPER.with_memory(memory)), families.NAME)
        return count_memories(text, family).total()

    assert count("simple") == block_rams
    try:
        assert count("dual") == 0
    except ToolError as error:
        assert "no valid mapping found for memory" in str(error)


def test_a_lane_that_is_not_in_block_ram_stops_the_count(monkeypatch):
    lanes = lanes_of(RGB24)
    assert len(lanes) == 16
    found = Counter(dict.fromkeys(sorted(lanes)[1:], 1))
    monkeypatch.setattr(families, "generate", lambda *_: ("module splatline; endmodule", {}))
    monkeypatch.setattr(families, "_map_memories", lambda *_: found)
    with pytest.raises(ToolError, match="1 lanes are not in block RAM: lane_0_0"):
        count_family(RGB24, "xc7")


def test_each_cell_is_counted_or_known_to_take_nothing():
    flow = FAMILY_FLOWS["xc7"]
    cells = {"\\LUT6": 3, "FDRE": 2, "RAM32M": 2, "RAMB36E1": 1, "RAMB18E1": 1, "CARRY4": 9}
    counted = {"lut": 11, "ff": 2, "bram": 3, "mult": 0}
    assert families._count(flow, {**cells, "$scopeinfo": 1}) == counted
    with pytest.raises(ToolError, match="7-series: it is not known what the cell URAM288 takes"):
        families._count(flow, {"URAM288": 1})
