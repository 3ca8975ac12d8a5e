import dataclasses
import importlib.util
from pathlib import Path

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.sim import golden
from splatline.sim.cosim.standalone.frames import bench_frames

PATH = Path(__file__).parents[2] / "examples" / "amaranth" / "still_picture.py"


@pytest.fixture(scope="module")
def example():
    """The example, which is no package's module."""
    spec = importlib.util.spec_from_file_location("still_picture", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def frame():
    return bench_frames(PAPER)[0]


def without_a_word(frame):
    """Yield the frame without each of its words, from the middle on."""
    for number in range(len(frame.codewords) // 2, len(frame.codewords) - 1):
        yield dataclasses.replace(frame, codewords=np.delete(frame.codewords, number))


def is_other_picture(one, other):
    return golden.render(one).mismatches(golden.render(other)) > 0


def test_the_picture_is_goldens(example, frame, capsys):
    assert example.main(frame) == 0
    assert ", 0 unlike golden" in capsys.readouterr().out


def test_a_word_that_is_lost_is_noticed(example, frame, capsys):
    less = next(each for each in without_a_word(frame) if is_other_picture(each, frame))
    design = example.StillPicture(less)
    assert example.main(frame, design) == 1
    assert ", 0 unlike golden" not in capsys.readouterr().out
