"""A system's Verilog."""

import logging
import re

import pytest

from splatline.contract.presets import RGB24

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards.simulated import SMALL, SimulatedSoC
from splatline.boards.verilog import system_files


def test_it_says_nothing_of_when_and_where_it_was_made():
    logging.disable(logging.INFO)
    text = system_files(SimulatedSoC(RGB24, SMALL), RGB24)["board.v"]
    assert not re.findall(r"[0-9]{4}-[0-9]{2}-[0-9]{2}|sha1|[0-9]{2}:[0-9]{2}:[0-9]{2}", text)
