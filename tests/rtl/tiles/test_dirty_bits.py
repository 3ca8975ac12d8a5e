"""The marks, against a set of pairs: what was touched is handed out once, with its stretch."""

import random

import cocotb
import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.tiles.dirty_bits import RESIDUES, TileDirtyBits, mark_bits, stretches
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, PAIRED, run_bench

WORDS = 1 << CONFIG.word_bits
PAIRS = 1 << mark_bits(CONFIG)  # of a stretch
STRETCHES = stretches(CONFIG)
LINES = CONFIG.window_lines


class Touch:
    """What is written in a cycle; by residue, whether its first and second word, and its group."""

    def __init__(self, word, touched, groups, second=None):
        self.touched, self.groups = touched, groups
        self.words = word, (word + 1) % WORDS if second is None else second

    @classmethod
    def random(cls, rng, word):
        """A tile's words; or one word of a line alone, where the second's number means nothing."""
        groups = [rng.randrange(4) for _ in range(RESIDUES)]
        if rng.random() < 0.3:
            touched = [(0, 0)] * RESIDUES
            touched[rng.randrange(RESIDUES)] = (1, 0)
            return cls(word, touched, groups, rng.randrange(WORDS))
        touched = [(rng.randrange(2), rng.randrange(2)) for _ in range(RESIDUES)]
        return cls(word, touched, groups)

    def dirty_bits(self, load=None):
        """The pairs that it and ``load`` (word, line) write, {(place of the line, pair)}."""
        pairs = {
            (4 * group + residue, word // 2)
            for residue, (group, flags) in enumerate(zip(self.groups, self.touched, strict=True))
            for word, flag in zip(self.words, flags, strict=True)
            if flag
        }
        return pairs if load is None else pairs | {(load[1] % LINES, load[0] // 2)}

    def without(self, residue):
        """The same, but for what is written into lines of a residue."""
        touched = [(0, 0) if q == residue else flags for q, flags in enumerate(self.touched)]
        return Touch(self.words[0], touched, self.groups, self.words[1])

    def drive(self, dut, idle=False, load=None):
        """``load``: a word and its line, which nothing else is written into."""
        groups, loads = list(self.groups), 0
        # Where the tile writes nothing, it may be the word that is loaded.
        lone = sum((not any(flags)) << q for q, flags in enumerate(self.touched))
        dut.lone.value = lone
        if load is not None:
            assert lone >> load[1] % 4 & 1
            groups[load[1] % 4], loads = load[1] % LINES // 4, 1 << load[1] % 4
            dut.load_word.value = load[0]
        dut.words.value = self.words[0] | self.words[1] << CONFIG.word_bits
        dut.group.value = sum(group << 2 * q for q, group in enumerate(groups))
        flags = sum((a | b << 1) << 2 * q for q, (a, b) in enumerate(self.touched))
        dut.touch.value, dut.load.value = (0, 0) if idle else (flags, loads)


def stretch_of(pairs, line, stretch):
    """Those of the pairs that lie in a stretch of a line."""
    return {(a, b) for a, b in pairs if (a, b // PAIRS) == (line, stretch)}


async def take(dut, bench, rng, line, stretch, wipe=0, beside=None):
    """Take a stretch, or wipe it in all lines of the group; return its pairs.

    ``beside``: what is touched meanwhile.
    """
    noise = Touch.random(rng, rng.randrange(WORDS))
    seen = {}

    def drive():
        if beside is None:
            noise.drive(dut, idle=True)
        else:
            beside.drive(dut)
        dut.take.value, dut.wipe.value = 1, wipe
        dut.line.value, dut.stretch.value = line, stretch

    def observe():
        seen["taken"] = int(dut.taken.value)

    await bench.step(drive, observe)
    dut.take.value = dut.wipe.value = 0
    return {(line, PAIRS * stretch + n) for n in range(PAIRS) if seen["taken"] >> n & 1}


async def start(dut, seed):
    """A bench whose marks have all been wiped, as after a reset."""
    rng, bench = random.Random(seed), StreamBench(dut, seed)
    for name in (
        "touch",
        "group",
        "words",
        "load",
        "load_word",
        "lone",
        "take",
        "line",
        "stretch",
        "wipe",
    ):
        getattr(dut, name).value = 0
    await bench.reset()
    for group in range(4):
        for stretch in range(STRETCHES):
            await take(dut, bench, rng, 4 * group, stretch, wipe=1)
    return rng, bench


@cocotb.test()
async def random_touches(dut):
    """Tiles anywhere or close together, words loaded beside them, stretches taken among them.

    In the end, nothing is left.
    """
    for seed, (words, share) in enumerate([(WORDS, 0.05), (WORDS, 0.4), (6, 0.1), (34, 0.3)]):
        rng, bench = await start(dut, seed)
        marked = set()
        first = 0 if words == WORDS else 28  # across the border of two stretches
        for _ in range(700):
            if rng.random() < share:
                line, stretch = rng.randrange(LINES), rng.randrange(STRETCHES)
                expected = stretch_of(marked, line, stretch)
                beside = None
                if CONFIG.flush_words == 2:
                    beside = Touch.random(rng, rng.randrange(WORDS)).without(line % 4)
                assert await take(dut, bench, rng, line, stretch, beside=beside) == expected
                marked -= expected
                marked |= beside.dirty_bits() if beside else set()
            else:
                touch = Touch.random(rng, (first + rng.randrange(words)) % WORDS)
                load = rng.randrange(WORDS), rng.randrange(LINES)
                if rng.random() < 0.3 or any(touch.touched[load[1] % 4]):
                    load = None
                await bench.step(lambda touch=touch, load=load: touch.drive(dut, load=load))
                marked |= touch.dirty_bits(load)
        for line in range(LINES):
            for stretch in range(STRETCHES):
                expected = stretch_of(marked, line, stretch)
                assert await take(dut, bench, rng, line, stretch) == expected
                assert await take(dut, bench, rng, line, stretch) == set()


@cocotb.test()
async def every_word_marks_its_pair(dut):
    """Each word as a tile's first and second, taken at once after the touch."""
    rng, bench = await start(dut, 5)
    for word in range(WORDS):
        for flags in ((1, 0), (0, 1), (1, 1)):
            if word == WORDS - 1 and flags[1]:
                continue  # there is no next word
            line = rng.randrange(LINES)
            touched = [flags if q == line % 4 else (0, 0) for q in range(RESIDUES)]
            touch = Touch(word, touched, [line // 4] * RESIDUES)
            await bench.step(lambda touch=touch: touch.drive(dut))
            taken = set()
            for stretch in {pair // PAIRS for _, pair in touch.dirty_bits()}:
                taken |= await take(dut, bench, rng, line, stretch)
            assert taken == touch.dirty_bits(), (word, flags)


@cocotb.test()
async def a_wipe_takes_four_lines_and_no_more(dut):
    """Everything is marked; a wipe clears a stretch of its group's lines alone."""
    rng, bench = await start(dut, 6)
    marked = set()
    for group in range(4):
        for word in range(0, WORDS, 2):
            touch = Touch(word, [(1, 0)] * RESIDUES, [group] * RESIDUES)
            await bench.step(lambda touch=touch: touch.drive(dut))
            marked |= touch.dirty_bits()
    assert len(marked) == LINES * STRETCHES * PAIRS
    for group, stretch in ((2, 1), (0, 0), (3, STRETCHES - 1)):
        await take(dut, bench, rng, 4 * group, stretch, wipe=1)
        for line in range(4 * group, 4 * group + 4):
            marked -= stretch_of(marked, line, stretch)
    for line in range(LINES):
        for stretch in range(STRETCHES):
            expected = stretch_of(marked, line, stretch)
            assert await take(dut, bench, rng, line, stretch) == expected


@pytest.mark.parametrize("config", [PAPER, PAIRED], ids=lambda config: config.name)
def test_dirty_bits_are_what_was_touched(config, block_simulator):
    run_bench(config, TileDirtyBits, __file__, simulator_name=block_simulator)
