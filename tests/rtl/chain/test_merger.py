"""The merger against a model of it in plain Python, on streams that stall apart."""

import random

import cocotb

from splatline.contract.presets import PAPER, PRESETS
from splatline.rtl.chain.merger import Merger
from splatline.rtl.layouts import RasterLayout
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, run_bench

BEAT = RasterLayout(CONFIG)
END = BEAT.size - 1
"""The bit of a beat that ends a frame."""

PIXELS = CONFIG.raster_pixels
WORDS = CONFIG.max_width // PIXELS
BACKGROUND = (CONFIG.background_depth, 0)
RATES = [(1.0, 1.0, 1.0), (0.5, 0.9, 1.0), (0.9, 0.3, 0.6), (1.0, 1.0, 0.3)]


def random_picture(rng, places):
    """Words by their place (line, word): pixels of (depth, colour), at least one of them drawn."""
    picture = {}
    for place in places:
        # Few depths, so that ties are common, and the two ends of their range.
        pixels = [
            (rng.choice([0, 1, 255, 256, 510]), rng.getrandbits(9))
            if rng.random() < 0.6
            else BACKGROUND
            for _ in range(PIXELS)
        ]
        if all(pixel == BACKGROUND for pixel in pixels):
            pixels[rng.randrange(PIXELS)] = (rng.randrange(511), rng.getrandbits(9))
        picture[place] = pixels
    return picture


def pictures(rng):
    """Pairs of pictures: alike, apart, interleaved, one of them empty, both empty."""
    every = [
        (line, word) for line in (0, 1, 2, 511, 1023) for word in (0, 1, 2, WORDS // 2, WORDS - 1)
    ]
    for _ in range(2):
        for shares in ((1.0, 1.0), (0.5, 0.5), (0.1, 0.9), (0.0, 0.6), (0.6, 0.0), (0.0, 0.0)):
            yield [
                random_picture(rng, [place for place in every if rng.random() < share])
                for share in shares
            ]
        cut = rng.randrange(len(every))
        yield [random_picture(rng, every[:cut]), random_picture(rng, every[cut:])]
        yield [random_picture(rng, every[cut:]), random_picture(rng, every[:cut])]


def over(before, own):
    """What drawing one picture over another gives: the depth test is Z < stored."""
    joined = dict(before)
    for place, pixels in own.items():
        stored = before.get(place, [BACKGROUND] * PIXELS)
        joined[place] = [
            new if new[0] < old[0] else old for old, new in zip(stored, pixels, strict=True)
        ]
    return joined


def to_beats(rng, picture):
    """A picture's beats; the fields of the end beat mean nothing."""
    for (line, word), pixels in sorted(picture.items()):
        depth, colour = zip(*pixels, strict=True)
        yield pack(BEAT, pixels={"depth": depth, "colour": colour}, word=word, line=line)
    yield rng.getrandbits(BEAT.size) | 1 << END


def check(received, expected):
    """Beats of several frames are those of the pictures; of an end beat the end alone counts."""
    received = iter(received)
    for picture in expected:
        for (line, word), pixels in sorted(picture.items()):
            beat = unpack(BEAT, next(received))
            assert (beat.end, beat.line, beat.word) == (0, line, word)
            assert [(beat.pixels.depth[n], beat.pixels.colour[n]) for n in range(PIXELS)] == pixels
        assert unpack(BEAT, next(received)).end
    assert next(received, None) is None


@cocotb.test()
async def one_over_the_other(dut):
    for seed, (before_rate, own_rate, rate) in enumerate(RATES):
        rng = random.Random(seed)
        pairs = list(pictures(rng))
        bench = StreamBench(dut, seed)
        ends = len(pairs)
        for name, side, share in (("before", 0, before_rate), ("own", 1, own_rate)):
            beats = [beat for pair in pairs for beat in to_beats(rng, pair[side])]
            bench.source(name, beats, share)
        sink = bench.sink("o", rate)
        await bench.reset()
        await bench.run(
            lambda sink=sink, ends=ends: sum(b >> END for b in sink.received) == ends,
            # At least half as many again as it takes: a beat that is lost is soon missed.
            most_cycles=round(500 / min(before_rate, own_rate, rate)),
            after=20,
        )
        check(sink.received, [over(*pair) for pair in pairs])


@cocotb.test()
async def a_beat_a_cycle(dut):
    """Neither side's beats nor those of both cost more than a cycle, and two for the way."""
    rng = random.Random(9)
    places = [(line, word) for line in range(4) for word in range(min(50, WORDS))]
    for before, own in (
        (places[::2], places[1::2]),
        (places, places),
        (places[: len(places) // 2], places[len(places) // 2 :]),
    ):
        bench = StreamBench(dut, 1)
        pair = [random_picture(rng, before), random_picture(rng, own)]
        bench.source("before", to_beats(rng, pair[0]))
        bench.source("own", to_beats(rng, pair[1]))
        sink = bench.sink("o")
        await bench.reset()
        beats = len(over(*pair)) + 1
        cycles = await bench.run(
            lambda sink=sink, beats=beats: len(sink.received) == beats, most_cycles=2000
        )
        assert cycles == beats + 2


@cocotb.test()
async def nothing_goes_on_before_the_other_side_is_known(dut):
    rng = random.Random(3)
    bench = StreamBench(dut, 2)
    bench.source("before", to_beats(rng, random_picture(rng, [(0, 0), (0, 1)])))
    sink = bench.sink("o")
    dut.own__valid.value = 0
    await bench.reset()
    for _ in range(20):
        await bench.step()
    assert not sink.received


def test_the_merger_draws_one_picture_over_the_other(block_simulator):
    run_bench(PAPER, Merger, __file__, simulator_name=block_simulator)


def test_the_merger_takes_beats_of_sixteen_pixels():
    run_bench(PRESETS["swift"], Merger, __file__, simulator_name="verilator")
