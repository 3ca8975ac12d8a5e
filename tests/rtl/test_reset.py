"""The first frame after a short reset, with undefined inputs before and between transfers.

Icarus has undefined values, and Verilator has not. The benches drive them on every idle input.
"""

import dataclasses
import functools

import numpy as np
import pytest

from splatline.contract.presets import PAPER, PLANE, SWIFT, SWIFT_PLANE
from splatline.flow.verilog import generate
from splatline.host.device.driver import Engine
from splatline.rtl.blocks.window import BlockWindow
from splatline.rtl.tiles.window import TileWindow
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.axi.axi_device import SimulatedDevice, build_axi
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.bus.axi_cases import clean, draw_scene
from tests.support import bus_words
from tests.support.engines import engine, mismatches
from tests.support.planted import plant, play_with
from tests.support.random_frames import random_raster, shapes

in_icarus = pytest.mark.skipif(not simulator.available("icarus"), reason="Icarus is not installed")

EDITIONS = ("2001", "2005", "2005-sv", "2009", "2012")
"""Editions of Verilog and SystemVerilog that Icarus reads."""

BLOCKS = SWIFT.replace(channel_bits=3, coefficient_bits=6, colour_shift=10)
"""The same with fewer bits, which Icarus draws in less time."""

PLANES = SWIFT_PLANE.replace(channel_bits=3, coefficient_bits=6, colour_shift=10)
"""Blocks with planes. All lanes compare depths, which are undefined where nothing is drawn."""

FAULTS = {
    (PAPER, TileWindow): [("_draw", r"Mux\(self\.i\.valid, tile\.z, 0\)", "tile.z")],
    # All ones, if it is defined.
    (PLANE, TileWindow): [("_draw_depth", r"eq\(~0\)", "eq(given | ~given)")],
    (BLOCKS, BlockWindow): [
        ("_follow", r"self\.i\.valid & other\.drawn", "other.drawn"),
        ("_follow", r"known & \(", "self.i.valid & ("),
    ],
}


def jobs(config, edges):
    """Frames after a reset at the start and in the middle, with gaps and an initial raster."""
    rng = np.random.default_rng(7)
    size = (32, 36)  # more lines than the window has
    frame = bus_words.clean(config, 7, 30, *size)
    return [
        Job(frame=frame, reset_edges=edges, rates={"codeword": 0.3}),
        Job(
            frame=frame,
            reset_after=90,
            reset_edges=edges,
            initial=random_raster(rng, 32, 36, 0.1, config),
            rates={"initial": 0.5},
        ),
    ]


def wrong_pixels(draw, config, edges):
    """Return how many pixels of the jobs, as ``draw`` plays them, differ from golden's."""
    played = jobs(config, edges)
    return sum(map(mismatches, played, draw(played)))


@functools.cache
def planted(config, part):
    """Build an engine with all of a part's faults, for Icarus."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [(part, *fault) for fault in FAULTS[config, part]])
        return wrap(edit(generate(config)[0]), config, simulator_name="icarus")


@in_icarus
@pytest.mark.parametrize(
    "config, edges",
    [(PAPER, 1), (PAPER, 4), (PLANE, 1), (PLANES, 1)],
    ids=["paper-1", "paper-4", "plane-1", "planes-1"],
)
def test_the_first_frame_after_a_short_reset_is_right(config, edges):
    assert wrong_pixels(functools.partial(play, built=engine(config, "icarus")), config, edges) == 0


@in_icarus
@pytest.mark.parametrize("config, part", FAULTS, ids=["tiles", "planes", "blocks"])
def test_undefined_values_that_reach_a_lane_are_noticed(config, part):
    """Without a fault none reaches one. A choice by a known value passes on no other's."""
    built = planted(config, part)
    assert wrong_pixels(functools.partial(play_with, 0, built=built), config, 1) == 0
    first, *_ = jobs(config, 1)  # which is enough
    for number in range(1, len(FAULTS[config, part]) + 1):
        assert mismatches(first, *play_with(number, [first], built))


@in_icarus
@pytest.mark.parametrize(
    "edition, edges", [*((edition, 1) for edition in EDITIONS), (EDITIONS[-1], 4)]
)
def test_the_first_frame_on_axi_in_every_edition_of_verilog(edition, edges):
    built = build_axi(PAPER, "icarus", options=[f"-g{edition}"])
    frame = clean(PAPER, 3, 20)
    with SimulatedDevice(PAPER, built=built, reset_edges=edges) as device:
        assert draw_scene(Engine(device), frame).mismatches(golden.render(frame)) == 0


@in_icarus
def test_blocks_that_nothing_starts_are_noticed():
    """A register that has its value from the start wakes no block in SystemVerilog."""

    def edit(text):
        return text.replace("reg _start_;\n  initial _start_ <= 0;", "reg _start_ = 0;")

    built = build_axi(PAPER, "icarus", edit=edit, options=["-g2012"])
    with SimulatedDevice(PAPER, built=built) as device, pytest.raises(SimulationError):
        draw_scene(Engine(device), clean(PAPER, 3, 20))


@in_icarus
@pytest.mark.parametrize("config", [BLOCKS, PLANE], ids=["blocks", "plane"])
def test_the_first_frame_of_other_engines_on_axi(config):
    frame = clean(config, 3, 20)
    with SimulatedDevice(config, built=build_axi(config, "icarus"), reset_edges=1) as device:
        assert draw_scene(Engine(device), frame).mismatches(golden.render(frame)) == 0


def test_a_reset_clears_the_registers_and_keeps_the_materials():
    rng = np.random.default_rng(5)
    before = shapes(rng, 40, 32, 30)
    assert before.tables.ambient.any()
    dark = dataclasses.replace(before.tables, ambient=np.zeros_like(before.tables.ambient))
    after = dataclasses.replace(before, tables=dark, width=512, height=512)
    played = [
        Job(frame=before),
        Job(frame=after, reset_after=5, reset_edges=1, write_tables="none"),
    ]
    outcomes = play(played, built=engine(PAPER, "verilator"))
    assert [mismatches(*pair) for pair in zip(played, outcomes, strict=True)] == [0, 0]
    assert outcomes[1].raster.drawn.any()
