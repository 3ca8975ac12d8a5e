"""Elements for the benches of both tilers, and the window that their tiles or blocks go to."""

import random
from abc import ABC, abstractmethod

from splatline.rtl.layouts import GeometryLayout
from splatline.sim.cosim.blocks import unpack
from splatline.sim.cosim.streams import StreamBench
from tests.rtl.tiles.tiles import LOWEST
from tests.support.bench_config import CONFIG

__all__ = ["END", "ROW_CODES", "ElementSlide", "pack_element", "random_rows", "sorted_frames"]

TOPS = 1 << CONFIG.line_bits + 2
END = ([(1, 0)] * 4, 1, 300, LOWEST)
PLACES = {name: (f.offset, f.width) for name, f in GeometryLayout(CONFIG)}
ROW_CODES = [(first, last) for first in range(8) for last in range(8)]


def pack_element(rows, mode, x, top, **rest):
    """Bits of an element; ``rest`` are further fields."""
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    bits = 0
    for name, value in {"scans": scans, "mode": mode, "x": x, "top": top, **rest}.items():
        if name in PLACES:
            offset, width = PLACES[name]
            bits |= (value & (1 << width) - 1) << offset
    return bits


def random_rows(rng):
    """Four rows: any, mostly empty, or within a few columns."""
    kind = rng.randrange(4)
    if kind == 0:
        return [rng.choice(ROW_CODES) for _ in range(4)]
    if kind == 1:
        return [rng.choice([(1, 0), (7, 3), rng.choice(ROW_CODES)]) for _ in range(4)]
    low = rng.randrange(5)
    return [(low + rng.randrange(2), low + rng.randrange(4)) for _ in range(4)]


class ElementSlide(ABC):
    """A tiler whose window follows its ``top``, and elements that wait for the end of a frame.

    Each cycle it checks what comes beside the stream: ``moves``, ``top``, and that the colour that
    moves with it would meet its tile; and that no tile comes before its lines (``in_window``). A
    subclass says what a tile is, or a block: its ``layout``, and the stages on the way to it.

    Parameters
    ----------
    cases
        Elements (rows, mode, x, top), or END.
    follow
        Share of the cycles in which the window goes on, and lines that it then goes at most.
    """

    layout = None

    def __init__(self, dut, bench, cases, depths, rates, follow=(1.0, LOWEST)):
        self.dut, self.bench, self.cases, self.follow = dut, bench, cases, follow
        words = [
            pack_element(*case, z=z, end=case is END) for case, z in zip(cases, depths, strict=True)
        ]
        self.depths = depths
        self.ends = [n for n, case in enumerate(cases) if case is END]
        self.source = bench.source("i", [], rates[0])
        self.source.payloads = Until(words, self.may_send)
        self.sink = bench.sink("o", rates[1])
        self.oldest = 0
        self.shown = self.first_line(None)  # as ``top`` must be in this cycle
        self.seen = 0  # elements that were taken
        self.hand = None  # the one that was taken last; none after the end of a frame
        self.moved = None  # the one whose colour moved last
        self.taken = self.waiting = False  # in the cycle before
        self.over = 0  # ends that were taken
        self.at_once = []  # of each tile, whether the one before was taken in the cycle before

    @classmethod
    def begin(cls, dut, cases, width, height, rates=(1.0, 1.0), seed=1, follow=(1.0, LOWEST)):
        """A bench that is not reset yet, and depths that tell its elements apart."""
        rng = random.Random(seed)
        first = rng.getrandbits(CONFIG.depth_bits)
        depths = [(first + 7 * n) % (1 << CONFIG.depth_bits) for n in range(len(cases))]
        dut.last_column.value, dut.last_line.value = width - 1, height - 1
        dut.oldest.value = 0
        return cls(dut, StreamBench(dut, seed), cases, depths, rates, follow)

    def may_send(self):
        """As many as there are before an end that was not taken, and that end itself."""
        return self.ends[self.over] + 1 if self.over < len(self.ends) else len(self.cases)

    @abstractmethod
    def in_window(self, bits, case):
        """Whether all lines of what is offered of an element are in the window."""

    def check_moves(self, valid, ready):
        """Check what says that a colour moves on, by what is offered and taken in this cycle."""
        assert int(self.dut.moves.value) == (not valid or ready)

    def move_on(self, over):
        """Let the stages hold what they do in the next cycle; ``over``: an end was taken."""
        if over:
            self.shown, self.hand, self.moved = self.first_line(None), None, None
        elif not self.waiting and self.hand is not None:
            self.moved, self.shown = self.hand, self.first_line(self.hand)

    def first_line(self, number):
        """Return an element's first line; the next frame's first possible one for none."""
        return -4 if number is None else self.cases[number][3]

    def drive(self):
        self.dut.oldest.value = self.oldest

    def observe(self):
        dut, sent = self.dut, self.source.sent
        valid, ready = int(dut.o__valid.value), int(dut.o__ready.value)
        bits = dut.o__payload.value
        top = self.layout["top"]
        assert int(bits[top.offset + top.width - 1 : top.offset]) == self.shown % TOPS
        self.check_moves(valid, ready)
        payload = unpack(self.layout, int(bits)) if valid else None
        ends = valid and payload.end
        if valid and not self.waiting:
            self.at_once.append(self.taken)
            case = self.cases[self.moved]
            assert payload.z == self.depths[self.moved], "another's colour"
            assert ends == (case is END)
            if not ends:
                assert self.in_window(int(bits), case), "a tile before its lines"
        self.taken = valid and ready
        self.waiting = valid and not ready
        # As in the window: it follows what is shown, and starts again after the end.
        if self.shown > self.oldest and self.bench.random.random() < self.follow[0]:
            self.oldest += min(self.shown - self.oldest, self.follow[1])
        over = self.taken and ends
        if over:
            self.oldest = 0
            self.over += 1
        self.move_on(over)
        if sent != self.seen:
            self.hand, self.seen = sent - 1, sent

    async def run(self):
        """Send everything; return the cycles until the last element was taken."""
        begin = self.bench.cycles
        await self.bench.run(
            lambda: self.source.sent == len(self.cases),
            most_cycles=80_000,
            drive=self.drive,
            observe=self.observe,
            after=0,
        )
        cycles = self.bench.cycles - begin
        for _ in range(6 if (self.sink.rate, self.follow) == (1.0, (1.0, LOWEST)) else 100):
            await self.bench.step(self.drive, self.observe)
        return cycles


class Until:
    """Payloads of which no more may come than a function tells."""

    def __init__(self, payloads, most):
        self.payloads, self.most = payloads, most

    def __len__(self):
        return self.most()

    def __getitem__(self, n):
        return self.payloads[n]


def sorted_frames(rng, frames, elements, lines, step=0.5):
    """Frames of elements in the order of their lines, each with its end."""
    cases = []
    for _ in range(frames):
        top = -4
        for _ in range(rng.randrange(elements + 1)):
            top += rng.randrange(lines) if rng.random() < step else 0
            cases.append((random_rows(rng), rng.randrange(2), rng.randrange(99), top))
        cases.append(END)
    return cases
