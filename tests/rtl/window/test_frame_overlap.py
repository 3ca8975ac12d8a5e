"""The change from one frame to the next: where the window lies for each, and when one is over."""

import random

import cocotb
import pytest
from cocotb.triggers import Timer

from splatline.contract.presets import PAPER
from splatline.rtl.window.frame_overlap import FrameOverlap
from splatline.sim.cosim import simulator
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.cosim.streams import StreamBench
from tests.support.faults import rewrite

INPUTS = ("oldest", "line", "leaves", "wraps", "clean", "close", "restart")


class Walk:
    """A flush scan in software: lines that are written, those that leave, and frames that follow.

    Places hold lines as (frame, line); a place that is taken twice, or a line that leaves with
    another frame, is an error of the component.
    """

    def __init__(self, dut, seed):
        self.dut, self.random = dut, random.Random(seed)
        self.bench = StreamBench(dut, seed)
        self.frame = 0  # that leaves
        self.oldest = 0
        self.places = {}
        self.overlaps = 0

    async def start(self):
        for name in INPUTS:
            getattr(self.dut, name).value = 0
        await self.bench.reset()

    async def cycle(self, share, height, stalls):
        """One cycle: a line may be written, one may leave, the frame may end or be over."""
        dut, rng, turn = self.dut, self.random, PAPER.window_lines
        dut.oldest.value = dut.line.value = self.oldest
        dut.clean.value = not self.places
        dut.close.value = dut.restart.value = dut.leaves.value = dut.wraps.value = 0
        await Timer(1, unit="ns")
        closing, halted = int(dut.closing.value), int(dut.halted.value)
        front = dut.front.value.to_signed()
        assert front == self.oldest if not closing else -2 * turn <= front < 0

        frame = self.frame + closing
        # Not the oldest line, which may leave.
        lines = range(max(front + 1, 0), min(front + turn, height))
        written = None
        ends = not closing and rng.random() < 0.02
        if lines and not ends and rng.random() < share:
            written = rng.choice(lines)
            holder = self.places.get(written % turn, (frame, written))
            assert holder == (frame, written), "a line in the place of one that is still there"
            self.overlaps += closing
        dut.wraps.value = written is not None and written % turn < self.oldest % turn

        leaves = not halted and (closing or rng.random() < 0.3) and rng.random() >= stalls
        dut.leaves.value = leaves
        dut.close.value = ends
        await Timer(1, unit="ns")
        over = int(dut.over.value)
        left = [owner for owner in self.places.values() if owner[0] == self.frame]
        assert not over or not left, "over while lines of it are there"
        restart = over and rng.random() < 0.3
        dut.restart.value = restart
        stays = int(dut.last.value)

        await self.bench.step()
        if leaves:
            owner = self.places.pop(self.oldest % turn, (self.frame, self.oldest))
            assert owner == (self.frame, self.oldest), "a line leaves with the frame before"
            self.oldest += not stays
        if written is not None:
            self.places[written % turn] = frame, written
        if restart:
            assert ends or closing
            self.frame, self.oldest = self.frame + 1, 0
        return over, closing


@cocotb.test()
async def no_place_is_taken_twice_and_no_line_leaves_with_another_frame(dut):
    """Dense and sparse frames, short and long ones; lines that leave at once, or hardly."""
    for seed, (share, height, stalls) in enumerate(
        [(0.5, 500, 0.2), (0.9, 40, 0.5), (0.1, 37, 0.0), (0.02, 300, 0.3), (1.0, 5, 0.7)]
    ):
        walk = Walk(dut, seed)
        await walk.start()
        waited = 0
        for _ in range(4000):
            over, closing = await walk.cycle(share, height, stalls)
            waited = 0 if over or not closing else waited + 1
            most = 2 * PAPER.window_lines / (1 - stalls)
            assert waited <= (5 * most if stalls else most), "it is never over"
        assert walk.frame > 20
        assert walk.overlaps > 20 or share < 0.1, "nothing was drawn while a frame left"


def test_frames_change_over(block_simulator):
    run_bench(FrameOverlap(PAPER), __file__, simulator_name=block_simulator)


FAULTS = [
    (r"self\.wraps & ~self\.closing", "0", "lines a turn ahead unnoticed"),
    (r"self\.wraps & ~self\.closing", "self.wraps", "those of the next frame noticed"),
    (r"turns\[1:\], self\.closing", "turns[1:], 0", "the next frame behind the first line"),
    (r"turn_ends & self\.closing & ~wrapped", "turn_ends & self.closing", "halted a turn early"),
    (r"self\.clean \| self\.halted", "1", "over at once"),
]


@pytest.mark.planted
@pytest.mark.parametrize(
    ("pattern", "replacement"),
    [pytest.param(*planted[:2], id=planted[2]) for planted in FAULTS],
)
def test_a_wrong_rule_is_noticed(monkeypatch, pattern, replacement):
    rewrite(monkeypatch, FrameOverlap, "elaborate", pattern, replacement)
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    with pytest.raises(SimulationError, match="failed"):
        run_bench(FrameOverlap(PAPER), __file__, simulator_name=quickest)
