"""A row of lanes: depth test and write back in two words at once."""

import itertools
import random

import cocotb

from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.lane_row import (
    HALVES,
    BeatWordsLayout,
    LaneRow,
    RowRequestLayout,
    row_address_bits,
)
from splatline.rtl.layouts import PixelLayout
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, run_bench

REQUEST, PIXEL, BEAT = RowRequestLayout(CONFIG), PixelLayout(CONFIG), BeatWordsLayout(CONFIG)
PLACES = 1 << row_address_bits(CONFIG)
COLUMNS = CONFIG.pixels_per_word
DEPTHS = CONFIG.background_depth + 1
BACKGROUND = (CONFIG.background_depth, 0)
WORDS = 1 << CONFIG.word_bits - 1
"""Words of a half that a line has."""
SETTLES = 2
"""Cycles after a request in which what it writes is not to be read, nor loaded."""
ALL = [(half, column) for half in (0, 1) for column in range(COLUMNS)]
BLANK = dict.fromkeys(ALL, BACKGROUND)


class Draw:
    """A pixel for some columns, {column: half}: of the even word (0) or of the odd one."""

    kind = "draw"
    sets = ("draw",)

    def __init__(self, columns, pixel, places):
        self.columns, self.pixel, self.places = columns, pixel, places

    @property
    def reads(self):
        """What is compared or copied, as (half, place, column)."""
        return {(half, self.places[half], column) for column, half in self.columns.items()}

    writes = reads


class Clear:
    """Both words leave."""

    kind = "clear"
    sets = ("store", "clear")

    def __init__(self, places):
        self.places = places

    @property
    def reads(self):
        return {(half, self.places[half], column) for half, column in ALL}

    writes = reads


class Load:
    """A pixel of each column for the odd word, or for both."""

    kind = "load"
    sets = ("store",)

    def __init__(self, both, pixels, places):
        self.both, self.pixels, self.places = both, pixels, places

    @property
    def reads(self):
        return {(half, self.places[half], column) for half, column in ALL if half or self.both}

    writes = reads


class Operator:
    """Sends requests a cycle at a time and keeps the pixels as they ought to be.

    What leaves is compared in every cycle. Draws may follow each other into any pixel.
    """

    def __init__(self, dut, seed):
        self.dut, self.random, self.bench = dut, random.Random(seed), StreamBench(dut, seed)
        self.pixels = {}
        self.latest = [None] * SETTLES  # requests whose pixels are still to be written
        self.new = [BACKGROUND] * COLUMNS  # what was requested to be written in the cycle before
        self.coming, self.leaving = None, None  # words that leave; before the reset unknown

    async def reset(self):
        dut = self.dut
        dut.request.value = dut.new_.value = dut.outside.value = 0
        await self.bench.reset()
        self.coming = self.leaving = None
        for place in range(PLACES):
            self.pixels |= dict.fromkeys(Clear((place, place)).reads, BACKGROUND)
            await self.cycle(Clear((place, place)), known=False)
        await self.settle()

    async def settle(self):
        """Let all be written."""
        for _ in range(SETTLES):
            await self.cycle()

    def may(self, request):
        """Whether no pixel of it is being written, but where both are drawn."""
        return not any(
            request.reads & other.writes
            for other in self.latest
            if other and not (request.kind == other.kind == "draw")
        )

    def after(self, request):
        """What of a draw's request tells of the two requests before."""
        draws = [other if isinstance(other, Draw) else None for other in self.latest]
        again = [
            {
                name: int(
                    bool(other) and request.places[half] % WORDS == other.places[half] % WORDS
                )
                for half, name in enumerate(HALVES)
            }
            for other in draws
        ]
        nearer = [other and other.pixel[0] <= request.pixel[0] for other in draws]
        behind = [self.random.randrange(2) if near is None else near for near in nearer]
        return {"again": again, "behind": behind[0] | behind[1] << 1}

    async def cycle(self, request=None, known=True):
        """One cycle; what means nothing is random."""
        rng, dut = self.random, self.dut
        assert request is None or self.may(request)
        places = request.places if request else [rng.randrange(PLACES) for _ in HALVES]
        fields = {"addresses": dict(zip(HALVES, places, strict=True))}
        fields |= {"mask": rng.getrandbits(COLUMNS), "odd": rng.getrandbits(COLUMNS)}
        fields["again"] = [{name: rng.randrange(2) for name in HALVES} for _ in range(2)]
        fields["behind"] = rng.randrange(4)
        fields["both"] = 0 if isinstance(request, Draw) else rng.randrange(2)
        outside = [rng.choice([0, rng.getrandbits(COLUMNS)]) for _ in HALVES]
        new, self.new = self.new, [random_pixel(rng) for _ in range(COLUMNS)]
        if request:
            fields |= dict.fromkeys(request.sets, 1)
        if isinstance(request, Draw):
            self.new = [request.pixel] * COLUMNS
            fields |= self.after(request)
            fields["mask"] = sum(1 << column for column in request.columns)
            odd = sum(half << column for column, half in request.columns.items())
            fields["odd"] = odd | fields["odd"] & ~fields["mask"]
        if isinstance(request, Load):
            self.new = request.pixels
            fields["mask"] = fields["odd"] = (1 << COLUMNS) - 1
            fields["both"] = request.both

        def drive():
            dut.request.value = pack(REQUEST, **fields)
            dut.outside.value = outside[0] | outside[1] << COLUMNS
            dut.new_.value = sum(
                pack(PIXEL, depth=depth, colour=colour) << column * PIXEL.size
                for column, (depth, colour) in enumerate(new)
            )

        def observe():
            if self.leaving is not None:
                words = unpack(BEAT, int(dut.leaving.value))
                words = [getattr(words, name) for name in HALVES]
                found = {(h, c): (words[h].depth[c], words[h].colour[c]) for h, c in ALL}
                assert found == self.leaving

        await self.bench.step(drive, observe)
        self.leaving, self.coming = self.coming, BLANK
        self._take(request, outside)
        if not known:  # what stood there before the first clear
            self.coming = None

    def _take(self, request, outside):
        self.latest = [request, *self.latest[:-1]]
        if request is None:
            return
        for half, place, column in request.reads:
            key = half, place, column
            if isinstance(request, Load):
                self.pixels[key] = request.pixels[column]
            elif isinstance(request, Clear):
                if not outside[half] >> column & 1:
                    self.coming = {**self.coming, (half, column): self.pixels[key]}
                self.pixels[key] = BACKGROUND
            elif request.pixel[0] < self.pixels[key][0]:
                self.pixels[key] = request.pixel

    async def read(self, places):
        """Clear two words, and let them leave."""
        await self.cycle(Clear(places))
        await self.settle()


def random_pixel(rng, step=1):
    return rng.randrange(0, DEPTHS, step), rng.randrange(1 << CONFIG.colour_bits)


def random_request(rng, spread, step):
    """Two places of as many as ``spread``; depths in steps, so that ties are common."""
    places = [rng.randrange(spread) * (PLACES // spread) for _ in HALVES]
    chance = rng.random()
    if chance < 0.15:
        return Clear(places)
    if chance < 0.3:
        return Load(rng.randrange(2), [random_pixel(rng, step) for _ in range(COLUMNS)], places)
    share = rng.choice([0.2, 0.5, 1.0])
    columns = {column: rng.randrange(2) for column in range(COLUMNS) if rng.random() < share}
    return Draw(columns, random_pixel(rng, step), places)


@cocotb.test()
async def random_requests(dut):
    """Few places, then all; few depths, so that ties are common; no request now and then."""
    for seed, (spread, step) in enumerate([(2, 1), (4, 100), (PLACES, 128), (8, 1)]):
        rng, operator, taken = random.Random(seed), Operator(dut, seed), 0
        await operator.reset()
        for _ in range(600):
            request = random_request(rng, spread, step) if rng.random() < 0.9 else None
            if request and not operator.may(request):
                request = None
            taken += request is not None
            await operator.cycle(request)
        assert taken > 300
        await operator.settle()
        for place in range(0, PLACES, PLACES // spread):
            await operator.read((place, place))
            await operator.read((place, place))


@cocotb.test()
async def nearer_wins_and_equal_stays(dut):
    """Z < stored draws, Z == stored and Z > stored do not; the background's depth never does."""
    operator = Operator(dut, 9)
    await operator.reset()
    furthest = BACKGROUND[0]
    for columns in ({column: column % 2 for column in range(COLUMNS)}, {3: 0}, {3: 1}):
        for depths, stays in (
            ((100, 100, 101, furthest), (100, 0)),
            ((100, 99, 99, 0, 0), (0, 3)),
            ((furthest, furthest), BACKGROUND),
            ((furthest, furthest - 1), (furthest - 1, 1)),
        ):
            for colour, depth in enumerate(depths):
                await operator.cycle(Draw(columns, (depth, colour), (7, 8)))
                await operator.settle()
            expected = {operator.pixels[half, 7 + half, column] for column, half in columns.items()}
            assert expected == {stays}
            await operator.read((7, 8))


@cocotb.test()
async def neighbours_follow_without_a_gap(dut):
    """Other columns, the other word or another place, in the cycles after a draw."""
    operator = Operator(dut, 10)
    await operator.reset()
    last = PLACES - 1
    for n, (columns, places) in enumerate(
        [
            ({0: 0, 1: 1}, (0, last)),
            ({0: 1, 1: 0}, (0, last)),
            ({2: 0, 7: 1}, (0, last)),
            ({2: 0, 7: 1}, (last, 0)),
        ]
    ):
        await operator.cycle(Draw(columns, (50 - n, n), places))
    await operator.settle()
    for places in ((0, 0), (last, last)):
        await operator.read(places)


@cocotb.test()
async def one_pixel_a_cycle(dut):
    """Three draws of one pixel one after the other, in every order of what lies before what.

    And with a draw elsewhere between them: of other columns, of the other half, of the same word
    of another line.
    """
    operator = Operator(dut, 12)
    await operator.reset()
    place, elsewhere = 5, 5 + WORDS
    here = Draw({3: 1}, None, (9, place))
    others = [None, Draw({2: 1, 4: 1}, (0, 7), (9, place)), Draw({3: 0}, (0, 7), (place, place))]
    others += [Draw({3: 1}, (0, 7), (9, elsewhere))]
    for depths in itertools.product((10, 11, 12), repeat=3):
        for between in itertools.product(range(len(others) + 1), repeat=2):
            for number, depth in enumerate(depths):
                await operator.cycle(Draw(here.columns, (depth, number), here.places))
                if number < 2 and between[number]:
                    await operator.cycle(others[between[number] - 1])
            await operator.settle()
            expected = min(depths), depths.index(min(depths))
            assert operator.pixels[1, place, 3] == expected
            for places in ((9, place), (place, elsewhere)):
                await operator.read(places)


@cocotb.test()
async def what_is_loaded_is_there_whatever_was(dut):
    """Behind or before the old pixel, or background; in either word, next to what is drawn."""
    operator = Operator(dut, 11)
    await operator.reset()
    columns = dict.fromkeys(range(COLUMNS), 0)
    for pixel in ((100, 1), (200, 2), (50, 3), BACKGROUND):
        pixels = [pixel, *(random_pixel(operator.random) for _ in range(COLUMNS - 1))]
        for places in ((13, 12), (12, 13)):
            await operator.cycle(Draw(columns, (300, 5), places))
        await operator.settle()
        await operator.cycle(Load(1, pixels, (13, 12)))
        for _ in range(SETTLES):
            await operator.cycle(Draw(columns, (250, 4), (12, 12)))
        await operator.cycle(Load(0, pixels[::-1], (13, 12)))
        await operator.cycle(Draw(columns, (150, 6), (13, 12)))
        await operator.settle()
        await operator.read((13, 12))
        await operator.read((12, 13))


def test_row_of_lanes_keeps_the_nearest():
    run_bench(SWIFT, LaneRow, __file__)
