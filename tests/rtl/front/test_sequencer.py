"""Control words: which line each element is told."""

import random

import cocotb

from splatline.contract.presets import PAPER
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.layouts import ElementLayout
from splatline.sim.cosim.blocks import run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

ELEMENT = ElementLayout(PAPER)
EMPTY_ROWS = sum(1 << PAPER.first(row).lsb for row in range(4))
LOWEST = (1 << PAPER.line_bits + 1) - 1


def advance(lines, noise=0):
    keep = ~(PAPER.x.mask << PAPER.x.lsb | PAPER.scans.mask << PAPER.scans.lsb | 1 << 25 | 1)
    return noise & keep | 1 | EMPTY_ROWS | lines << PAPER.x.lsb


def end(noise=0):
    return advance(0, noise) | 1 << PAPER.control_end.lsb


def is_control(word):
    rows = [word >> 1 + 6 * row & 63 for row in range(4)]
    return word & 1 and all(row & 7 > row >> 3 for row in rows)


def expected_tokens(words):
    """Tokens by docs/contract.md: (end, line, the word's own fields)."""
    tokens, line = [], 0
    for word in words:
        if not is_control(word):
            tokens.append((0, min(line - 4, LOWEST), word))
        elif word >> 25 & 1:
            tokens.append((1, LOWEST, None))
            line = 0
        else:
            line += word >> 46 & 511
    return tokens


def check_tokens(received, expected):
    assert len(received) == len(expected)
    for bits, (is_end, top, word) in zip(received, expected, strict=True):
        token = unpack(ELEMENT, bits)
        assert (token.end, token.top) == (is_end, top)
        if word is not None:
            assert token.mode == word & 1
            assert bits >> ELEMENT["scans"].offset & (1 << 24) - 1 == word >> 1 & (1 << 24) - 1
            assert (token.diffuse, token.specular) == (word >> 25 & 127, word >> 32 & 127)
            assert (token.material, token.x, token.z) == (
                word >> 39 & 127,
                word >> 46 & 511,
                word >> 55,
            )


@cocotb.test()
async def random_words(dut):
    """Random words, with many control words and many frames among them."""
    for seed, rates in enumerate([(1.0, 1.0), (0.5, 0.9), (0.9, 0.3), (0.2, 1.0)]):
        rng = random.Random(seed)
        words = []
        for _ in range(2000):
            noise = rng.getrandbits(64)
            kind = rng.random()
            if kind < 0.2:
                words.append(advance(rng.choice([0, 1, 2, 7, 100, 511]), noise))
            elif kind < 0.23:
                words.append(end(noise))
            else:
                words.append(noise)
        expected = expected_tokens(words)
        bench = StreamBench(dut, seed)
        source = bench.source("i", words, rates[0])
        sink = bench.sink("o", rates[1])
        dut.admit.value = 1
        await bench.reset()
        await bench.run(
            lambda source=source: source.sent == len(source.payloads), most_cycles=40_000, after=40
        )
        check_tokens(sink.received, expected)


@cocotb.test()
async def the_line_saturates(dut):
    """Far past every image the line stands still; the next frame begins at the top."""
    element = 0b111000_111000_111000_111000_0
    words = [advance(511), element] * 12 + [end(), element]
    bench = StreamBench(dut, 7)
    bench.source("i", words)
    sink = bench.sink("o")
    dut.admit.value = 1
    await bench.reset()
    await bench.run(lambda: len(sink.received) == 14, most_cycles=200)
    tops = [unpack(ELEMENT, bits).top for bits in sink.received]
    assert tops == [min(511 * n - 4, LOWEST) for n in range(1, 13)] + [LOWEST, -4]


@cocotb.test()
async def a_frame_opens_only_when_admitted(dut):
    """Without admission the first word waits; an open frame goes on regardless."""
    element = 0b111000_111000_111000_111000_0
    bench = StreamBench(dut, 8)
    source = bench.source("i", [element, element, end(), element])
    bench.sink("o")
    dut.admit.value = 0
    await bench.reset()
    for _ in range(10):
        await bench.step()
    assert (source.sent, int(dut.open.value)) == (0, 0)
    await bench.step(lambda: setattr(dut.admit, "value", 1))
    assert (source.sent, int(dut.open.value)) == (1, 1)
    for _ in range(10):
        await bench.step(lambda: setattr(dut.admit, "value", 0))
    assert (source.sent, int(dut.open.value)) == (3, 0), "the next frame waits"


def test_sequencer_follows_control_words(block_simulator):
    run_bench(Sequencer(PAPER), __file__, simulator_name=block_simulator)
