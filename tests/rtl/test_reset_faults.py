"""Planted faults that let undefined values in after a reset: the frames must notice them."""

import functools

import pytest

from splatline.contract.presets import PAPER, PLANE
from splatline.flow.verilog import generate
from splatline.host.device.driver import Engine
from splatline.rtl.blocks.plane_row import PlaneLaneRow
from splatline.rtl.blocks.window import BlockWindow
from splatline.rtl.tiles.window import TileWindow
from splatline.sim.cosim.axi.axi_device import SimulatedDevice, build_axi
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.bus.axi_cases import clean, draw_scene
from tests.rtl.test_reset import BLOCKS, PLANES, in_icarus, jobs, wrong_pixels
from tests.support.engines import mismatches
from tests.support.planted import plant, play_with

pytestmark = pytest.mark.planted

FAULTS = {
    (PAPER, TileWindow): [("_draw", r"Mux\(self\.i\.valid, tile\.z, 0\)", "tile.z")],
    # All ones, if it is defined.
    (PLANE, TileWindow): [("_draw_depth", r"eq\(~0\)", "eq(given | ~given)")],
    # What is not offered draws nothing, so its undefined depth alone reaches no lane.
    (BLOCKS, BlockWindow): [("_follow", r"known & \(", "self.i.valid & (")],
    # A clear subtracts what it reads, from whichever word.
    (PLANES, PlaneLaneRow): [
        ("_meet", r"Mux\(self\.request\.clear, -1, self\.request\.odd\)", "self.request.odd")
    ],
}


@functools.cache
def planted(config, part):
    """Build an engine with all of a part's faults, for Icarus."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [(part, *fault) for fault in FAULTS[config, part]])
        return wrap(edit(generate(config)[0]), config, simulator_name="icarus")


@in_icarus
@pytest.mark.parametrize("config, part", FAULTS, ids=["tiles", "plane", "blocks", "planes"])
def test_undefined_values_that_reach_a_lane_are_noticed(config, part):
    """Without a fault none reaches one. A choice by a known value passes on no other's."""
    built = planted(config, part)
    assert wrong_pixels(functools.partial(play_with, 0, built=built), config, 1) == 0
    first, *_ = jobs(config, 1)  # which is enough
    for number in range(1, len(FAULTS[config, part]) + 1):
        assert mismatches(first, *play_with(number, [first], built))


@in_icarus
def test_blocks_that_nothing_starts_are_noticed():
    """A register that has its value from the start wakes no block in SystemVerilog."""

    def edit(text):
        return text.replace("reg _start_;\n  initial _start_ <= 0;", "reg _start_ = 0;")

    built = build_axi(PAPER, "icarus", edit=edit, options=["-g2012"])
    with SimulatedDevice(PAPER, built=built) as device, pytest.raises(SimulationError):
        draw_scene(Engine(device), clean(PAPER, 3, 20))
