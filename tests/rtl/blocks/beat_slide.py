"""The bench of the flush scan over beats: what was written, and what must leave."""

from cocotb.triggers import Timer

from splatline.rtl.layouts import PlaceLayout
from tests.rtl.blocks.test_dirty_bits import (
    BEATS,
    LINES,
    NOTHING,
    RESIDUES,
    STRETCHES,
    WORDS,
    Touch,
)
from tests.rtl.window.slides import Slide
from tests.support.bench_config import CONFIG

__all__ = ["LINE", "LOWEST", "BeatSlide", "random_touch", "stretch_word"]

PLACE = PlaceLayout(CONFIG)
LOWEST = (1 << CONFIG.line_bits + 1) - 1
LINE = WORDS // 2  # beats of a line


class BeatSlide(Slide):
    """A flush scan over rows of lanes whose window slides down an image.

    Beats are named by their even word. ``next`` are those of the frame behind the one that leaves.
    """

    def __init__(self, dut, seed, rate=1.0):
        super().__init__(dut, seed, rate, PLACE, LOWEST)
        self.left = 0  # beats of ``expected`` that were taken
        self.came = 0  # times it was said that the window comes to ``top``
        self.pending = set()
        self.next = set()

    async def start(self, jump=1):
        self.dut.jump.value = jump
        inputs = ("drawing", "touch", "group", "words", "reaching", "restart", "close", "enable")
        inputs += ("load", "load_word", "lone", "top", "limit")
        groups = LINES // RESIDUES
        await self.reset(inputs, self.dut.wipe_row, range(groups * STRETCHES))

    async def cycle(self, top, touch=NOTHING, enable=1, limit=LOWEST, load=None):
        """One cycle; return whether what was to be written was.

        ``enable``: marks may be taken where the block has no line, or go first; else it goes first.
        A load goes before marks. ``load``: word and line of the initial raster, of a residue that
        ``touch`` leaves free.
        """
        dut = self.dut
        dut.top.value, dut.limit.value = (n % (1 << CONFIG.line_bits + 2) for n in (top, limit))
        await Timer(1, unit="ns")
        oldest, line = int(dut.oldest.value), int(dut.line.value)
        front = dut.front.value.to_signed()
        meets = touch.wants(line)
        waits = meets and enable == "first" and load is None
        # Of the other residues nothing counts.
        own = 1 << line % RESIDUES
        may = load is None and bool(enable) and (waits or not meets)
        dut.enable.value = -1 % (1 << RESIDUES) & ~own | may * own
        touch.drive(dut, drawing=not waits, load=load)
        dut.reaching.value = touch is not NOTHING
        closing = int(dut.closing.value)
        comes_to = None

        def observe():
            nonlocal comes_to
            goes = not int(dut.flush__valid.value) or int(dut.flush__ready.value)
            if int(dut.empties.value) and goes:
                comes_to = max(oldest, top)
            # What is closed is complete, and ``top`` is of the next frame.
            self.check_flush(oldest, LOWEST if closing else top)
            assert closing or front == oldest
            assert all(oldest <= pending for pending, _ in self.pending), "a line left too early"
            assert oldest <= line

        await self.bench.step(observe=observe)
        self.came += comes_to is not None
        assert comes_to in (None, int(dut.oldest.value)), "not where it was to come"
        for bits in self.flush.received[self.left :]:
            self.pending.remove(*self.words_of(bits))
        self.left = len(self.flush.received)
        written = (set() if waits else touch.dirty_bits()) | (
            NOTHING.dirty_bits(load) if load else set()
        )
        for place, beat in written:
            below = front + (place - front) % LINES
            if closing:
                self.next.add((below, 2 * beat))
            else:
                self.expected.add((below, 2 * beat))
                self.pending.add((below, 2 * beat))
        return not waits

    async def change(self, cycle):
        """Close the frame and go on with the next, which is drawn meanwhile in cycles of a kind.

        As the window does, in the cycle after ``over`` at the soonest: by then a beat of the next
        frame may have been written, and the frame is not called over any more.
        """
        dut = self.dut
        dut.close.value = 1
        await cycle()
        dut.close.value = 0
        for _ in range(5000):
            over = int(dut.over.value)
            await cycle()
            if over and self.bench.random.random() < 0.5:
                break
        assert over and [self.words_of(b)[0] for b in self.flush.received] == sorted(self.expected)
        dut.restart.value = 1
        await cycle()
        dut.restart.value = 0
        self.flush.received.clear()
        self.left = 0
        self.expected, self.next = self.next, set()
        self.pending = set(self.expected)

    async def finish(self, rng):
        """Let everything leave, and compare."""
        tops = [LOWEST]  # of the end token; then of the next frame

        async def cycle():
            await self.cycle(tops.pop() if tops else -4, enable=rng.random() < 0.8)

        await self.leave(cycle)
        assert not self.pending
        assert await self.cycle(-4)
        assert int(self.dut.oldest.value) == 0


def random_touch(rng, top, word, share=0.5, low=0):
    """Words of a block on the eight lines from ``top`` on; none above ``low``."""
    last = word == WORDS - 1
    touched, groups = [(0, 0)] * RESIDUES, [0] * RESIDUES
    for line in range(top, top + 8):
        if line >= low and rng.random() < share:
            touched[line % 8] = rng.randrange(2), rng.randrange(2)
            if last:
                touched[line % 8] = touched[line % 8][0], 0
        groups[line % 8] = line // 8 % (LINES // RESIDUES)
    return Touch(word, touched, groups)


def stretch_word(stretch, beat=0, odd=0):
    """The number of a word of a stretch."""
    return 2 * (stretch * BEATS + beat) + odd
