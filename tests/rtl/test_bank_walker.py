"""The walker over banks: each drawn word is asked for once, in order, and nothing else is."""

import random

import cocotb
import pytest
from footprints import place_of_word
from presets import CONFIG, SINGLE, run_bench
from slides import Slide
from test_bank_marks import rows_of_marks

from splatline.rtl.bank_layout import bank_address_bits, stretch_bits
from splatline.rtl.bank_walker import BankWalker
from splatline.rtl.layouts import FlushLayout
from splatline.rtl.presets import PRESETS
from splatline.rtl.variants import BANKS16
from splatline.sim.cosim.blocks import unpack

PLACE, ADDRESS = FlushLayout(CONFIG), bank_address_bits(CONFIG)
WORDS = 1 << CONFIG.word_bits
LOWEST = (1 << CONFIG.line_bits + 1) - 1
STRETCHES = 1 << stretch_bits(CONFIG)
STRETCH = WORDS // STRETCHES


class BankSlide(Slide):
    """A walker over banks whose window slides down an image."""

    def __init__(self, dut, seed, rate=1.0):
        super().__init__(dut, seed, rate, PLACE, LOWEST)

    async def start(self, jump=1, last_word=WORDS - 1):
        self.dut.jump.value, self.dut.last_word.value = jump, last_word
        self.jump = jump
        self.before = (0, 0, 0, 0)
        self.early = 0  # cycles in which the front is known before the last word has left
        inputs = ("drawn", "addresses", "restart", "close", "top", "limit", "reach", "reaching")
        inputs += ("idle",)
        await self.reset(inputs, self.dut.addresses, rows_of_marks(CONFIG))

    async def cycle(self, top, words=(), limit=LOWEST, idle=False):
        """One cycle in which words (line, word) are drawn or loaded, each in a bank of its own.

        As in the window, the banks write them in the next cycle, and the walker hears of ``top``
        in that one as well, and of ``limit`` in that one at the earliest. None comes where it is
        ``idle``, nor in the cycle behind it.
        """
        assert not (words and idle)
        dut = self.dut
        drawn, addresses = 0, 0
        for line, word in words:
            bank, address = place_of_word(line, word)
            assert not drawn >> bank & 1
            drawn |= 1 << bank
            addresses |= address << ADDRESS * bank
            self.expected.add((line, word))
        if self.jump:  # it means nothing
            limit = self.bench.random.randrange(-4, LOWEST)
        reach = sum({1 << word // STRETCH for _, word in words})

        def drive():
            *lines, dut.drawn.value, dut.addresses.value = self.before
            dut.top.value, dut.limit.value = (n % (1 << CONFIG.line_bits + 2) for n in lines)
            # One stretch more may be reached in vain: the window is not told an element's width.
            dut.idle.value = idle
            dut.reaching.value, dut.reach.value = (
                bool(words),
                (reach | reach << 1) % (1 << STRETCHES),
            )

        def observe():
            self.check_flush(self.first(), top if self.jump else min(top, limit))
            self.check_front()

        await self.bench.step(drive, observe)
        self.before = top, limit, drawn, addresses

    def first(self):
        """The line of what is asked for if the front is past it, else the front."""
        oldest = int(self.dut.oldest.value)
        if not int(self.dut.flush__valid.value):
            return oldest
        return min(oldest, unpack(self.place, int(self.dut.flush__payload.value)).line)

    def check_front(self):
        """Of what was drawn above the front, nothing is left but what is asked for now."""
        dut = self.dut
        if int(dut.closing.value):
            return
        asked = self.words_of(int(dut.flush__payload.value)) if int(dut.flush__valid.value) else []
        taken = {place for bits in self.flush.received for place in self.words_of(bits)}
        front = dut.front.value.to_signed()
        self.early += front > self.first()
        assert all(line >= front for line, _ in self.expected - taken - set(asked))

    def words_of(self, bits):
        place = unpack(self.place, bits)
        turned = place.line >> 2 & 1 if CONFIG.banks == 8 else 0
        halves = [half for half in (turned, 1 - turned) if place.halves >> half & 1]
        assert 0 < len(halves) <= CONFIG.raster_words
        return [(place.line, 2 * place.pair + (half ^ turned)) for half in halves]

    async def finish(self):
        """Let everything leave, and compare."""
        await self.leave(lambda: self.cycle(LOWEST))
        await self.cycle(-4)
        assert int(self.dut.oldest.value) == 0


def random_words(rng, low, high, last_word, spread):
    """Words of lines low .. high, no two in a bank."""
    chosen = {}
    for _ in range(rng.randrange(9)):
        line = rng.randrange(low, high + 1)
        word = rng.randrange(max(0, last_word + 1 - spread), last_word + 1)
        chosen.setdefault(place_of_word(line, word)[0], (line, word))
    return list(chosen.values())


@cocotb.test()
async def drawn_words_are_asked_for_once_and_in_order(dut):
    """Dense and sparse images, wide and narrow, quick and slow sinks."""
    steps = [0] * 12 + [1, 1, 2, 9]
    for seed, (rate, height, last_word, spread, share, jump) in enumerate(
        [
            (1.0, 60, WORDS - 1, 30, 0.9, 1),
            (0.4, 60, WORDS - 1, WORDS, 0.3, 1),
            (0.7, 400, WORDS - 1, WORDS, 0.05, 0),
            (1.0, 60, 18, 19, 0.5, 0),
            (0.8, 60, 0, 1, 0.8, 1),
        ]
    ):
        rng, slide, top, limit = random.Random(seed), BankSlide(dut, seed, rate), 0, 0
        idle = False
        await slide.start(jump, last_word)
        for _ in range(5_000):  # a fault may keep it for ever; the longest takes 2,872
            oldest, words = slide.first(), []
            limit = max(limit, min(limit + rng.choice([0] * 20 + [1, 2]), oldest + 15))
            # What an initial raster is on its way to may be complete but for that.
            low, high = top if jump else min(top, limit), min(top + 7, oldest + 14)
            if low <= high and not idle and rng.random() < share:
                words = random_words(rng, low, high, last_word, spread)
            idle = not words and rng.random() < 0.5
            await slide.cycle(top, words, limit, idle)
            if top - oldest < 8:
                top += rng.choice(steps)
            if top >= height:
                break
        assert len(slide.expected) > 15
        await slide.finish()


@cocotb.test()
async def a_full_window_takes_a_cycle_a_beat(dut):
    """The marks of the next stretch are there when they are needed, and of the next line."""
    slide = BankSlide(dut, 7)
    await slide.start()
    for line in range(8):
        for word in range(WORDS):
            await slide.cycle(0, [(line, word)])
    begin, beats = slide.bench.cycles, 8 * WORDS // CONFIG.raster_words
    while len(slide.flush.received) < beats:
        assert slide.bench.cycles - begin <= beats + 6
        await slide.cycle(8)
    await slide.finish()


@cocotb.test()
async def a_stretch_that_nothing_reached_is_not_read(dut):
    """A line with a word costs the reading of two stretches, wherever they lie."""
    slide = BankSlide(dut, 11)
    await slide.start()
    for n, word in enumerate((0, 17, 30, WORDS - 12, WORDS - 1)):
        line = 16 * n
        await slide.cycle(line - 4)
        await slide.cycle(line, [(line, word)])
        begin = slide.bench.cycles
        while len(slide.flush.received) <= n:
            assert slide.bench.cycles - begin <= 7
            await slide.cycle(line + 1)
        for _ in range(4):
            await slide.cycle(line + 1)
        assert int(dut.oldest.value) == line + 1
    await slide.finish()


@cocotb.test()
async def the_front_is_known_with_the_last_word(dut):
    """What follows lies far below; unless others wait, or something may still be drawn."""
    last = WORDS - STRETCH  # of the last stretch, behind which none is read in vain
    several = [last + n for n in (0, 1, 4, 5, 8, 9, 12, 13)]
    for idle, words, times in ((True, [last], 10), (True, several, 0), (False, [last], 0)):
        slide = BankSlide(dut, 12)
        await slide.start()
        for line in range(0, 300, 30):
            await slide.cycle(line)
            for word in words:
                await slide.cycle(line, [(line, word)])
            for _ in range(14):
                await slide.cycle(line + 30, idle=idle)
        assert slide.early == (times if CONFIG.colour_planes == 1 else 0)
        await slide.finish()


@cocotb.test()
async def what_is_being_written_stays_behind_the_front(dut):
    """The window's first line, while a word above it waits and the lines below are complete."""
    for lag in range(8):
        slide = BankSlide(dut, lag, rate=0.2)
        await slide.start()
        for line in range(0, 600, 30):
            await slide.cycle(line, [(line, WORDS - STRETCH)])
            for _ in range(lag):
                await slide.cycle(line + 10)
            await slide.cycle(line + 10, [(line + 10, WORDS - 1)])
            for _ in range(40):
                await slide.cycle(line + 30, idle=True)
        await slide.finish()


@cocotb.test()
async def untouched_lines_leave_at_once(dut):
    """One by one before a drawn line; all at once from a clean window, if nothing is to come."""
    slide = BankSlide(dut, 8)
    await slide.start(jump=1)
    await slide.cycle(0, [(9, 50)])
    for _ in range(24):
        await slide.cycle(14)
    assert int(dut.oldest.value) == 14
    await slide.finish()
    slide = BankSlide(dut, 9)
    await slide.start(jump=1)
    for _ in range(5):
        await slide.cycle(700)
    assert int(dut.oldest.value) == 700
    await slide.finish()


@cocotb.test()
async def nothing_leaves_unasked(dut):
    """No line from ``top`` on, and none from ``limit`` on."""
    for case, (top, limit) in enumerate([(3, LOWEST), (12, 0), (12, 2), (12, 3), (2, 3)]):
        slide = BankSlide(dut, case)
        await slide.start(jump=0)
        await slide.cycle(0, [(3, WORDS - 29)], 0)
        for _ in range(20):
            await slide.cycle(top, limit=limit)
        assert not slide.flush.received
        assert int(dut.oldest.value) == min(top, limit)
        await slide.finish()
    slide = BankSlide(dut, 5, rate=0.2)
    await slide.start(jump=0)
    for word in (1, 2, 3, 50):
        await slide.cycle(0, [(0, word)], 0)
    for _ in range(80):
        await slide.cycle(14, limit=5)
        assert int(dut.oldest.value) <= 5, "lines entered the window before they were loaded"
    assert int(dut.oldest.value) == 5
    await slide.finish()


@pytest.mark.parametrize(
    "config", [PRESETS["wide"], BANKS16, PRESETS["deep"], SINGLE], ids=lambda config: config.name
)
def test_walker_asks_for_what_was_drawn(config):
    """``wide`` and ``banks16`` ask for two words at once, the others for one."""
    run_bench(config, BankWalker, __file__)
