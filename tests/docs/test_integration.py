"""The integration guide's tables of bad input: each row and rule has the tests that show it."""

import ast
import re
from pathlib import Path

import pytest

from splatline.contract.register_map import ERRORS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "integration.md").read_text(encoding="utf-8")
BUS, ABORT, STREAMS = (f"rtl/bus/axi_{name}cases.py" for name in ("bus_", "abort_", ""))
ENGINE, AXI = "rtl/test_engine.py", "rtl/bus/test_axi_top.py"
REGISTERS = "rtl/bus/test_axi_registers.py"
WRITER, SCREEN = (f"rtl/framebuffer/{name}_bench.py" for name in ("writer", "top"))

ROWS = {
    "an element right of the image": [
        (STREAMS, "an_element_beyond_the_last_column"),
        (STREAMS, "an_element_in_the_last_column"),
        (ENGINE, "test_every_border_is_clipped_exactly"),
    ],
    "a step below the image": [
        (STREAMS, "steps_past_the_frame"),
        (STREAMS, "a_step_that_overflows"),
        ("rtl/front/test_sequencer.py", "the_line_saturates"),
    ],
    "no end word": [
        (STREAMS, "a_frame_that_ends_early"),
        (ENGINE, "test_a_reset_in_the_middle_leaves_no_trace"),
    ],
    "words after the end word": [
        (STREAMS, "an_end_word_without_last"),
        (ENGINE, "test_frames_follow_while_the_one_before_leaves"),
    ],
    "a word with bytes missing (TKEEP)": [
        (STREAMS, "partial_words"),
        (STREAMS, "nothing_but_partial_words"),
        (STREAMS, "a_partial_end_word"),
    ],
    "a beat with bytes missing (TKEEP)": [
        (STREAMS, "a_partial_beat_of_an_initial_raster"),
    ],
    "an address where nothing is": [(BUS, "nothing_at_an_address")],
    "a write of what is read only, a read of what is write only": [
        (BUS, "writes_of_what_is_read_only"),
        (BUS, "reads_of_what_is_written_only"),
    ],
    "a write of less than 32 bits": [(BUS, "writes_of_some_bytes")],
    "a bit that a register has not": [(BUS, "bits_that_a_register_lacks")],
    "a table write within a frame": [
        (BUS, "tables_written_in_mid_frame"),
        (ENGINE, "test_tables_wait_until_the_end_beat_is_taken"),
    ],
    "a frame that is aborted": [(ABORT, "between_frames"), (ABORT, "abort")],
    "an initial raster that no frame wants": [
        (STREAMS, "an_initial_raster_that_nobody_asked_for"),
        (ENGINE, "test_an_initial_raster_waits_for_its_frame"),
    ],
    "initial beats out of order or outside": [
        ("rtl/tiles/test_window.py", "nonsense_in_the_initial_raster"),
    ],
    "an initial raster without its end beat": [
        (STREAMS, "an_initial_raster_that_ends_early"),
        (ABORT, "with_an_initial_raster_that_never_comes"),
    ],
    "initial beats after the end beat": [
        (STREAMS, "an_initial_raster_whose_end_is_not_last"),
    ],
    "a response of the frame buffer's memory is an error": [
        (WRITER, "responses_that_are_errors"),
    ],
    "a setting of the frame buffer changes within a frame": [(WRITER, "drive")],
    "`swapped` comes without `swap_valid`": [(WRITER, "drive")],
    "a buffer or `stride` is no multiple of the bus's bytes": [
        (WRITER, "low_bits_of_addresses"),
    ],
    "a materials' index without an entry": [],
}
"""Tests of each row of the table, by its first cell; the last row cannot be."""

RULES = {
    "Each cause has a bit": [
        (BUS, "an_interrupt_is_acknowledged_with_what_was_read"),
        (AXI, "test_a_reset_in_mid_frame"),
    ],
    "The same cause twice": [
        (REGISTERS, "test_a_cause_in_the_cycle_of_its_clearing_leaves_the_bit_set"),
    ],
    "One access or packet": [
        (BUS, "one_write_with_two_errors"),
        (STREAMS, "nothing_but_partial_words"),
    ],
    "A cause in the cycle": [
        (REGISTERS, "test_a_cause_in_the_cycle_of_its_clearing_leaves_the_bit_set"),
    ],
    "IRQ_STATUS.ERROR is 1": [
        (BUS, "an_interrupt_is_acknowledged_with_what_was_read"),
        (SCREEN, "frames_behind_each_other"),
    ],
    "`irq` is FRAME_DONE": [(AXI, "test_interrupts")],
    "A frame with an error": [(STREAMS, "expect"), (AXI, "test_interrupts")],
}
"""Tests of each rule of how causes add up, by its first words."""


def section(heading):
    """Return a section of the page."""
    return re.search(rf"^## {heading}\n(.*?)(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[1]


def table():
    """Return the rows of the table of bad input, each a list of cells."""
    rows = [line for line in section("What becomes of bad input").splitlines() if line[:1] == "|"]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]


def source(file, name):
    """Return the text of a function of a file of tests."""
    text = (ROOT / "tests" / file).read_text(encoding="utf-8")
    (found,) = [
        ast.get_source_segment(text, node)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name == name
    ]
    return found


def test_every_row_and_every_rule_has_tests():
    assert [row[0] for row in table()] == list(ROWS)
    rules = re.findall(r"^- (.*)$", section("How causes add up"), re.MULTILINE)
    assert len(rules) == len(RULES)
    assert all(rule.startswith(begin) for rule, begin in zip(rules, RULES, strict=True))
    for tests in (*ROWS.values(), *RULES.values()):
        for test in tests:
            assert source(*test)


def test_every_cause_is_in_the_table():
    named = [name for row in table() for name in re.findall(r"\b[A-Z]+_?[A-Z_]+\b", row[2])]
    assert sorted(set(named) - {"TLAST"}) == sorted(ERRORS)


@pytest.mark.parametrize("row", table(), ids=lambda row: row[0])
def test_the_tests_of_a_row_look_for_its_causes(row):
    names = set(re.findall(r"\b[A-Z]+_?[A-Z_]+\b", row[2])) & set(ERRORS)
    text = "\n".join(source(*test) for test in ROWS[row[0]])
    assert {name for name in names if f'"{name}"' in text or f"{name}=" in text} == names
