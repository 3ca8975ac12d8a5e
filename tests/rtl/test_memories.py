"""Engines whose memories have one port that writes and one that reads: pictures, cycles, faults.

The write port takes loads too, so initial rasters and stalls are what matters.
"""

import functools
import os

import numpy as np
import pytest

from splatline.contract.presets import LANES8, PAPER, PLANE, RGB24
from splatline.flow.verilog import generate
from splatline.host.frame_file import load_frame, save_frame
from splatline.rtl.tiles.lane import Lane
from splatline.rtl.tiles.window import TileWindow
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.cycles.cycles import count_cycles
from tests.rtl.test_presets import RATES
from tests.support import plane_words as pw
from tests.support.engines import engine, mismatches
from tests.support.planted import plant, play_with
from tests.support.random_frames import random_raster, shapes

SIMPLE = {config.name: config.with_memory("simple") for config in (PAPER, RGB24, PLANE, LANES8)}
PLAYED = list(SIMPLE) if os.environ.get("SPLATLINE_TEST_VARIANTS") == "all" else ["plane"]
"""A build each; that of ``plane`` has the faults too. All of them on demand."""

FAULTS = {
    "loaded beside a tile": (TileWindow, "_arbitrate", r"m\.If\(offered\)", "m.If(0)"),
    "a tile's colour": (TileWindow, "_draw", r"Mux\(offered, self\.shade, .*?\)\)", "self.shade)"),
    "not loaded": (TileWindow, "_connect_lanes", r"sweeping \| loads if", "sweeping if"),
    "a tile's depth": (
        TileWindow, "_connect_lanes", r"Mux\(grants\.offered, given, .*?\)", "given",
    ),
    "compared": (Lane, "elaborate", r"taken\.draw, taken\.clear", "taken.draw, 0"),
}  # fmt: skip


def some_frame(rng, config, count, width, height):
    """Elements like a host's, or with planes any words."""
    if config.plane:
        return pw.random_frame(rng, count, (width, height), config)
    return shapes(rng, count, width, height, config=config)


def jobs(config):
    """Two frames that are timed; then initial rasters under every pattern of stalls."""
    rng = np.random.default_rng(19)
    made = [Job(frame=some_frame(rng, config, 300, 61, 50)) for _ in range(2)]
    for seed, rates in enumerate(RATES):
        for width, height, share in ((40, 30, 0.5), (37, 60, 0.02), (130, 10, 1.0)):
            made.append(
                Job(
                    frame=some_frame(rng, config, 200, width, height),
                    followed_by=[some_frame(rng, config, 100, width, height)] * (seed % 2),
                    initial=random_raster(rng, width, height, share, config),
                    rates={**rates, "table": 1.0},
                    reset_after=400 if seed == 2 else None,
                    seed=seed,
                )
            )
    return made


@functools.cache
def planted():
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, FAULTS.values())
        return wrap(edit(generate(SIMPLE["plane"])[0]), SIMPLE["plane"])


@pytest.mark.parametrize("name", PLAYED)
def test_pictures_and_cycles_are_those_of_golden_and_of_the_cycle_model(name):
    played = jobs(SIMPLE[name])
    if name == "plane":
        outcomes = play_with(0, played, planted())
    else:
        outcomes = play(played, built=engine(SIMPLE[name]))
    assert list(map(mismatches, played, outcomes)) == [0] * len(played)
    counted = [count_cycles(job.frame, after_reset=n == 0) for n, job in enumerate(played[:2])]
    assert [outcome.cycles for outcome in outcomes[:2]] == counted


@pytest.mark.planted
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_a_load_is_noticed(name):
    played = jobs(SIMPLE["plane"])
    try:
        outcomes = play_with(list(FAULTS).index(name) + 1, played, planted())
    except SimulationError:
        return
    assert any(map(mismatches, played, outcomes))


def test_without_an_initial_raster_words_of_four_pixels_take_no_cycle_more():
    more = {}
    for config in (PAPER, RGB24, PLANE, LANES8):
        dual, simple = (
            count_cycles(some_frame(np.random.default_rng(3), one, 2000, 200, 60))
            for one in (config, SIMPLE[config.name])
        )
        more[config.name] = simple - dual
    # Words of eight pixels are flushed one at a request, not in pairs.
    assert more.pop("lanes8") > 0
    assert set(more.values()) == {0}


def test_a_frame_file_says_nothing_of_memories(tmp_path):
    for config in (RGB24, SIMPLE["rgb24"]):
        frame = some_frame(np.random.default_rng(4), config, 20, 32, 32)
        save_frame(frame, tmp_path / "frame")
        assert "memory" not in (tmp_path / "frame.json").read_text()
        assert load_frame(tmp_path / "frame").config == RGB24.replace(name=config.name)
