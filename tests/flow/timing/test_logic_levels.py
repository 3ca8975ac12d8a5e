import pytest

from splatline.flow.timing.logic_levels import longest_path

OUTPUTS = {"FDRE": "Q", "RAMB16_S36_S36": "DOA", "MULT18X18": "P"}


def cell(kind, out, **inputs):
    """A cell with one output; inputs by pin, a bit or a constant each."""
    pin = OUTPUTS.get(kind, "O")
    return {
        "type": kind,
        "port_directions": {pin: "output", **dict.fromkeys(inputs, "input")},
        "connections": {pin: [out], **{name: [bit] for name, bit in inputs.items()}},
    }


def module(cells, **names):
    nets = {name: {"hide_name": 0, "bits": bits} for name, bits in names.items()}
    return {"cells": dict(enumerate_names(cells)), "netnames": nets}


def enumerate_names(cells):
    return ((f"cell_{number}", found) for number, found in enumerate(cells))


def test_luts_in_a_row_are_levels_and_a_chain_of_carries_is_one():
    adder = [
        cell("FDRE", 1, C=99, D="0"),
        cell("LUT2", 2, I0=1, I1="1"),
        cell("MUXCY", 3, CI="0", DI=1, S=2),
        cell("MUXCY", 4, CI=3, DI="0", S="0"),
        cell("MUXCY", 5, CI=4, DI="0", S="0"),
        cell("XORCY", 6, CI=5, LI="0"),
        cell("LUT4", 7, I0=6, I1=1, I2="0", I3="0"),
        cell("FDRE", 8, C=99, D="0", CE=7),
    ]
    assert longest_path(module(adder, count=[40, 1], copy=[8])) == {
        "levels": 3, "luts": 2, "carries": 4, "multipliers": 0,
        "start": "count[1]", "end": "clock enable of copy",
    }  # fmt: skip


def test_memories_have_the_names_of_their_instances_and_clocks_are_no_path():
    cells = [
        cell("RAMB16_S36_S36", 1, CLKA=7, ADDRA="0"),
        cell("INV", 2, I=1),
        cell("MULT18X18", 3, A=2),
        cell("RAMB16_S36_S36", 4, CLKA=7, ADDRA=3),
        cell("LUT1", 5, I0=3),
        cell("LUT1", 6, I0=5),
        cell("LUT1", 7, I0=6),
        cell("OBUF", 8, I=7),
    ]
    assert longest_path(module(cells)) == {
        "levels": 1, "luts": 0, "carries": 0, "multipliers": 1,
        "start": "cell_0", "end": "cell_3 ADDRA",
    }  # fmt: skip


def test_a_memory_of_luts_is_read_at_once_and_written_by_the_clock():
    cells = [
        cell("FDRE", 1, C=9, D="0"),
        cell("RAM16X1S", 2, WCLK=9, A0=1, D=4, WE="1"),
        cell("LUT1", 3, I0=2),
        cell("LUT1", 4, I0=3),
    ]
    found = longest_path(module(cells, place=[1]))
    assert (found["levels"], found["luts"], found["end"]) == (3, 3, "cell_1 D")
    assert found["start"] == "place"


def test_a_signal_s_name_is_the_one_that_says_where_it_is():
    cells = [cell("FDRE", 1, C=9, D="0"), cell("FDRE", 2, C=9, D=1)]
    found = longest_path(module(cells, held=[1], **{"window.held": [1], "held$3": [1]}, other=[2]))
    assert (found["levels"], found["start"], found["end"]) == (0, "window.held", "other")


def test_of_as_many_levels_the_path_of_more_cells_is_taken():
    cells = [
        cell("FDRE", 1, C=9, D="0"),
        cell("LUT1", 2, I0=1),
        cell("FDRE", 3, C=9, D=2),
        cell("MUXCY", 4, CI="0", DI=1, S="0"),
        cell("XORCY", 5, CI=4, LI="0"),
        cell("FDRE", 6, C=9, D=5),
    ]
    found = longest_path(module(cells, one=[3], chain=[6]))
    assert (found["levels"], found["carries"], found["end"]) == (1, 2, "chain")


def test_a_register_without_a_name_in_the_source_goes_by_its_cell_s():
    cells = [cell("FDRE", 1, C=9, D="0"), cell("FDRE", 2, C=9, D="0", CE=1)]
    found = longest_path(module(cells))
    assert (found["start"], found["end"]) == ("cell_0", "clock enable of cell_1 CE")


def test_a_cell_that_is_not_known_and_a_path_that_is_not_there_are_told():
    with pytest.raises(RuntimeError, match="the cell SRL16 is not known"):
        longest_path(module([cell("SRL16", 1, A0=2)]))
    with pytest.raises(RuntimeError, match="no path"):
        longest_path(module([cell("FDRE", 1, C=2, D="0")]))
