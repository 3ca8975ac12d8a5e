"""Cutting beats of two words: each word that has something, the left one first."""

import random

import cocotb

from splatline.rtl.halver import Halver
from splatline.rtl.layouts import LoadLayout
from splatline.rtl.presets import WIDE
from splatline.sim.cosim.blocks import pack, run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

BEAT = WORD = LoadLayout(WIDE)
HALF, DEPTH = WIDE.pixels_per_word, WIDE.background_depth


def random_beat(rng):
    """A beat, either half of which may be background, and the words that it has."""
    word, line = rng.randrange(64), rng.randrange(1024)
    depths, words = [], []
    for _ in range(2):
        drawn = rng.random() < 0.6
        depth = [rng.choice([DEPTH, rng.randrange(DEPTH)]) if drawn else DEPTH for _ in range(HALF)]
        depths += depth
        words.append(depth)
    colours = [rng.getrandbits(9) for _ in depths]
    bits = pack(BEAT, pixels={"depth": depths, "colour": colours}, word=2 * word, line=line)
    kept = [
        (line, 2 * word + half, tuple(depth), tuple(colours[HALF * half : HALF * half + HALF]))
        for half, depth in enumerate(words)
        if half == 1 or set(depth) != {DEPTH}
    ]
    # Of a beat that is all background one word is left; else none of background.
    if len(kept) == 2 and set(words[1]) == {DEPTH}:
        kept.pop()
    return bits, kept


def own(word):
    """Return a word's line and number, and of its beat's pixels its own depths and colours."""
    first = HALF * (word.word % 2)
    pixels = slice(first, first + HALF)
    depths, colours = list(word.pixels.depth), list(word.pixels.colour)
    return word.line, word.word, tuple(depths[pixels]), tuple(colours[pixels])


@cocotb.test()
async def beats_come_out_as_their_words(dut):
    """Whatever the rates; without stalls a word a cycle."""
    for seed, rates in enumerate([(1.0, 1.0), (0.4, 0.9), (0.9, 0.4)]):
        rng = random.Random(seed)
        beats, expected = [], []
        for _ in range(300):
            bits, words = random_beat(rng)
            beats.append(bits)
            expected += words
        bench = StreamBench(dut, seed)
        bench.source("i", beats, rates[0])
        sink = bench.sink("o", rates[1])
        await bench.reset()
        cycles = await bench.run(lambda: len(sink.received) >= len(expected), most_cycles=5000)  # noqa: B023
        assert [own(unpack(WORD, bits)) for bits in sink.received] == expected
        if seed == 0:
            assert cycles <= len(expected) + 3


def test_a_beat_of_two_words_is_cut(block_simulator):
    run_bench(Halver(WIDE), __file__, simulator_name=block_simulator)
