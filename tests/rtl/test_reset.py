"""The first frame after a short reset, with undefined inputs before and between transfers.

Icarus has undefined values, and Verilator has not. The benches drive them on every idle input.
"""

import dataclasses
import functools

import numpy as np
import pytest

from splatline.contract.presets import PAPER, PLANE, SWIFT, SWIFT_PLANE
from splatline.host.device.driver import Engine
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.axi.axi_device import SimulatedDevice, build_axi
from splatline.sim.cosim.player.frames import Job, play
from tests.rtl.bus.axi_cases import clean, draw_scene
from tests.support import bus_words
from tests.support.engines import engine, mismatches
from tests.support.random_frames import random_raster, shapes

in_icarus = pytest.mark.skipif(not simulator.available("icarus"), reason="Icarus is not installed")

EDITIONS = ("2001", "2005", "2005-sv", "2009", "2012")
"""Editions of Verilog and SystemVerilog that Icarus reads."""

BLOCKS = SWIFT.replace(channel_bits=3, coefficient_bits=6, colour_shift=10)
"""The same with fewer bits, which Icarus draws in less time."""

PLANES = SWIFT_PLANE.replace(channel_bits=3, coefficient_bits=6, colour_shift=10)
"""Blocks with planes. All lanes compare depths, which are undefined where nothing is drawn."""


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


@in_icarus
@pytest.mark.parametrize(
    "config, edges",
    [(PAPER, 1), (PAPER, 4), (PLANE, 1), pytest.param(PLANES, 1, marks=pytest.mark.thorough)],
    ids=["paper-1", "paper-4", "plane-1", "planes-1"],
)
def test_the_first_frame_after_a_short_reset_is_right(config, edges):
    assert wrong_pixels(functools.partial(play, built=engine(config, "icarus")), config, edges) == 0


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
@pytest.mark.parametrize(
    "config", [pytest.param(BLOCKS, marks=pytest.mark.thorough), PLANE], ids=["blocks", "plane"]
)
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
