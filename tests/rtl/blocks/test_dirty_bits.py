"""The marks of beats, against a set of them: what was written is handed out once, by stretches."""

import random

import cocotb

from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.dirty_bits import BlockDirtyBits, mark_bits, residue_bits, stretch_bits
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, run_bench

WORDS = 1 << CONFIG.word_bits
RESIDUES = 1 << residue_bits(CONFIG)
BEATS = 1 << mark_bits(CONFIG)  # of a stretch
STRETCHES = 1 << stretch_bits(CONFIG)
LINES = CONFIG.window_lines
GROUPS = LINES // RESIDUES


class Touch:
    """A block's words: by residue of the line its group, and (odd, even): which word is written.

    ``word`` is the first of the two.
    """

    def __init__(self, word, touched, groups):
        self.touched, self.groups = touched, groups
        self.words = word, (word + 1) % WORDS

    @classmethod
    def random(cls, rng, word, share=0.5):
        """Words of any lines, but none behind the last one of a line."""
        last = word == WORDS - 1
        touched = [
            (rng.random() < share, not last and rng.random() < share) for _ in range(RESIDUES)
        ]
        return cls(word, touched, [rng.randrange(GROUPS) for _ in range(RESIDUES)])

    @classmethod
    def of_line(cls, line, word, first=True, second=False):
        """The first word, the second or both on one line, or on none."""
        odd, even = (first, second) if word % 2 else (second, first)
        touched = [
            (q == line % RESIDUES and odd, q == line % RESIDUES and even) for q in range(RESIDUES)
        ]
        return cls(word, touched, [line // RESIDUES % GROUPS] * RESIDUES)

    def wants(self, line):
        """Whether something is written in lines of a line's residue."""
        return any(self.touched[line % RESIDUES])

    def dirty_bits(self, load=None):
        """The beats that it and ``load`` (word, line) write, {(place of the line, beat)}."""
        number = {word % 2: word // 2 for word in self.words}
        beats = {
            (RESIDUES * group + residue, number[parity])
            for residue, (group, (odd, even)) in enumerate(
                zip(self.groups, self.touched, strict=True)
            )
            for parity, flag in ((1, odd), (0, even))
            if flag
        }
        return beats if load is None else beats | {(load[1] % LINES, load[0] // 2)}

    def drive(self, dut, drawing=1, load=None):
        """``load``: a word and its line, of a residue that the block leaves free."""
        groups, loads = list(self.groups), 0
        if load is not None:
            word, line = load
            assert not self.wants(line)
            groups[line % RESIDUES], loads = line % LINES // RESIDUES, 1 << line % RESIDUES
            dut.load_word.value = word
        dut.lone.value = sum((not self.wants(q)) << q for q in range(RESIDUES))
        dut.words.value = self.words[0] | self.words[1] << CONFIG.word_bits
        dut.group.value = sum(g << CONFIG.group_bits * q for q, g in enumerate(groups))
        dut.touch.value = sum((a | b << 1) << 2 * q for q, (a, b) in enumerate(self.touched))
        dut.drawing.value, dut.load.value = drawing, loads


NOTHING = Touch(0, [(0, 0)] * RESIDUES, [0] * RESIDUES)


def stretch_of(beats, line, stretch):
    """Those of the beats that lie in a stretch of a line."""
    return {(a, b) for a, b in beats if (a, b // BEATS) == (line, stretch)}


async def look(dut, bench, line, stretch, touch=NOTHING, take=1, wipe=0, drawing=1):
    """Look at a stretch while a block is drawn, and take it or not; return its beats."""
    seen = {}

    def drive():
        touch.drive(dut, drawing=drawing)
        dut.look.value = (1 << RESIDUES) - 1 if wipe else 1 << line % RESIDUES
        dut.take.value = take
        dut.line.value, dut.stretch.value = line, stretch

    def observe():
        seen["taken"] = int(dut.taken.value)

    await bench.step(drive, observe)
    dut.look.value = dut.take.value = 0
    return {(line, BEATS * stretch + n) for n in range(BEATS) if seen["taken"] >> n & 1}


async def start(dut, seed):
    """A bench whose marks have all been wiped, as after a reset."""
    rng, bench = random.Random(seed), StreamBench(dut, seed)
    inputs = ("drawing", "touch", "group", "words", "load", "load_word", "lone")
    for name in (*inputs, "look", "take", "line", "stretch"):
        getattr(dut, name).value = 0
    await bench.reset()
    for line in range(0, LINES, RESIDUES):
        for stretch in range(STRETCHES):
            await look(dut, bench, line, stretch, wipe=1)
    return rng, bench


async def compare(dut, bench, marked):
    """All that is marked is handed out, and nothing after that."""
    for line in range(LINES):
        for stretch in range(STRETCHES):
            expected = stretch_of(marked, line, stretch)
            assert await look(dut, bench, line, stretch) == expected
            assert await look(dut, bench, line, stretch) == set()


@cocotb.test()
async def random_touches(dut):
    """Blocks anywhere or close together, and beside each a beat that is loaded, or a stretch.

    That is taken or only looked at. Of what is not drawn, no mark is left.
    """
    for seed, (words, share) in enumerate([(WORDS, 0.1), (WORDS, 0.6), (4, 0.3), (18, 0.3)]):
        rng, bench = await start(dut, seed)
        marked, beside = set(), 0
        first = 0 if words == WORDS else 24  # across the border of two stretches
        for _ in range(700):
            word = (first + rng.randrange(words)) % WORDS
            touch = Touch.random(rng, word, rng.choice([0.1, 0.5, 1.0]))
            line, stretch = rng.randrange(LINES), rng.randrange(STRETCHES)
            drawing, take = rng.random() < 0.7, rng.random() < 0.5
            free = not touch.wants(line)
            if free and rng.random() < share:
                expected = stretch_of(marked, line, stretch)
                found = await look(dut, bench, line, stretch, touch, take, drawing=drawing)
                assert found == expected
                marked -= expected if take else set()
                beside += drawing and bool(touch.dirty_bits())
            else:
                load = (rng.randrange(WORDS), line) if free and rng.random() < 0.7 else None
                await bench.step(lambda t=touch, d=drawing, b=load: t.drive(dut, d, b))
                marked |= NOTHING.dirty_bits(load) if load else set()
            marked |= touch.dirty_bits() if drawing else set()
        assert beside > 10
        await compare(dut, bench, marked)


@cocotb.test()
async def every_word_marks_its_beat(dut):
    """Each word as a block's first and second, or loaded, taken at once after that."""
    rng, bench = await start(dut, 5)
    for word in range(WORDS):
        for first, second, loaded in ((1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1)):
            if word == WORDS - 1 and second:
                continue  # there is no next word
            line = rng.randrange(LINES)
            touch = Touch.of_line(line, word, first, second)
            load = (word, line) if loaded else None
            await bench.step(lambda touch=touch, load=load: touch.drive(dut, load=load))
            dut.load.value = 0
            taken = set()
            for stretch in {beat // BEATS for _, beat in touch.dirty_bits(load)}:
                taken |= await look(dut, bench, line, stretch)
            assert taken == touch.dirty_bits(load), (word, first, second)


@cocotb.test()
async def a_wipe_takes_a_group_of_lines_and_no_more(dut):
    """Everything is marked; a wipe clears a stretch of its group's lines alone."""
    _, bench = await start(dut, 6)
    marked = set()
    for group in range(GROUPS):
        for word in range(0, WORDS, 2):
            touch = Touch(word, [(1, 0)] * RESIDUES, [group] * RESIDUES)
            await bench.step(lambda touch=touch: touch.drive(dut))
            marked |= touch.dirty_bits()
    assert len(marked) == LINES * STRETCHES * BEATS
    for group, stretch in ((1, 1), (0, 0), (1, STRETCHES - 1)):
        await look(dut, bench, RESIDUES * group, stretch, wipe=1)
        for line in range(RESIDUES * group, RESIDUES * (group + 1)):
            marked -= stretch_of(marked, line, stretch)
    await compare(dut, bench, marked)


def test_dirty_bits_are_what_was_written():
    run_bench(SWIFT, BlockDirtyBits, __file__)
