"""Elements for the benches of both tilers, and a model of the window behind them."""

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
    """A bench of a tiler with a window that follows ``top``.

    Elements of the next frame are sent once the end of a frame was taken. In each cycle the bench
    checks ``moves`` and ``top``, that the colour which advances with ``moves`` belongs to the
    offered tile, and that its lines are in the window (``in_window``). A subclass has the
    ``layout`` of a tile or a block, and the tiler's stages.

    Parameters
    ----------
    cases
        Elements (rows, mode, x, top), or END.
    follow
        Share of the cycles in which the window moves, and the most lines that it moves by.
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
        self.shown = self.first_line(None)  # expected ``top`` of this cycle
        self.seen = 0  # elements that were taken
        self.hand = None  # the element taken last; none after the end of a frame
        self.moved = None  # the element whose colour advanced last
        self.taken = self.waiting = False  # a tile was taken, or waited, in the cycle before
        self.over = 0  # ends that were taken
        self.at_once = []  # for each tile: the tile before was taken in the cycle before

    @classmethod
    def begin(cls, dut, cases, width, height, rates=(1.0, 1.0), seed=1, follow=(1.0, LOWEST)):
        """Return a bench before its reset. Its elements have different depths."""
        rng = random.Random(seed)
        first = rng.getrandbits(CONFIG.depth_bits)
        depths = [(first + 7 * n) % (1 << CONFIG.depth_bits) for n in range(len(cases))]
        dut.last_column.value, dut.last_line.value = width - 1, height - 1
        dut.oldest.value = 0
        return cls(dut, StreamBench(dut, seed), cases, depths, rates, follow)

    def may_send(self):
        """Return how many elements may be sent: those up to the first end that was not taken."""
        return self.ends[self.over] + 1 if self.over < len(self.ends) else len(self.cases)

    @abstractmethod
    def in_window(self, bits, case):
        """Return whether all lines of the offered tile are in the window."""

    def check_moves(self, valid, ready):
        """Check ``moves``, which says that a colour advances."""
        assert int(self.dut.moves.value) == (not valid or ready)

    def move_on(self, over):
        """Advance the model of the stages by a cycle; ``over``: an end was taken."""
        if over:
            self.shown, self.hand, self.moved = self.first_line(None), None, None
        elif not self.waiting and self.hand is not None:
            self.moved, self.shown = self.hand, self.first_line(self.hand)

    def first_line(self, number):
        """Return an element's first line; without an element the first line of a new frame."""
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
        # The window follows ``top``, and starts again after the end.
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
    """A list of payloads with a length that a function returns."""

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
