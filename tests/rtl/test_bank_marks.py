"""The banks' marks, against a set of words: what was drawn is handed out with its stretch, once."""

import random

import cocotb
import pytest
from presets import CONFIG, run_bench

from splatline.rtl.bank_layout import bank_address_bits, column_bits, stretch_bits
from splatline.rtl.bank_marks import BankMarks
from splatline.rtl.presets import WIDE
from splatline.rtl.variants import ALL_OF_EIGHT, BANKS16
from splatline.sim.cosim import blocks
from splatline.sim.cosim.streams import StreamBench

ADDRESS = bank_address_bits(CONFIG)
COLUMNS, STRETCHES = 1 << column_bits(CONFIG), 1 << stretch_bits(CONFIG)
LINES = CONFIG.banks // 2
"""So many lines lie in different banks."""


def rows_of_marks(config):
    """Addresses of all banks, together in each row of their marks."""
    bits, columns = bank_address_bits(config), 1 << column_bits(config)
    for address in range(0, 1 << bits, columns):
        yield sum(address << bits * bank for bank in range(config.banks))


class Marked:
    """The marks as they ought to be, {(bank, address)}; words that share one have all of them."""

    def __init__(self, dut, seed, share):
        self.dut, self.share = dut, share
        self.bench = StreamBench(dut, seed)
        self.words = set()

    async def start(self):
        for name in ("drawn", "addresses", "line", "stretch", "take", "wipe"):
            getattr(self.dut, name).value = 0
        await self.bench.reset()
        self.dut.wipe.value = 1
        for row in rows_of_marks(CONFIG):
            await self.bench.step(lambda row=row: setattr(self.dut.addresses, "value", row))
        self.dut.wipe.value = 0

    def of(self, line, stretch):
        """A stretch's marks, as ``bits`` has them."""
        bits = 0
        for column in range(COLUMNS):
            address = (line // LINES * STRETCHES + stretch) * COLUMNS + column
            for half in range(2):
                bits |= ((line % LINES + LINES * half, address) in self.words) << 2 * column + half
        return bits

    async def cycle(self, drawn, line, stretch, take):
        """Draw into the banks' words {bank: address}; look at a stretch, and take it if it may."""
        dut, seen = self.dut, {}
        busy = line % LINES in drawn or line % LINES + LINES in drawn

        def drive():
            dut.drawn.value = sum(1 << bank for bank in drawn)
            dut.addresses.value = sum(at << ADDRESS * bank for bank, at in drawn.items())
            dut.line.value, dut.stretch.value = line, stretch
            dut.take.value = take and not busy

        def observe():
            seen["marks"], seen["busy"] = int(dut.bits.value), int(dut.busy.value)

        await self.bench.step(drive, observe)
        assert seen["busy"] == busy
        if not busy:
            assert seen["marks"] == self.of(line, stretch)
            if take:
                first = (line // LINES * STRETCHES + stretch) * COLUMNS
                for half in range(2):
                    bank = line % LINES + LINES * half
                    self.words -= {(bank, first + column) for column in range(COLUMNS)}
        for bank, address in drawn.items():
            first = address - address % self.share
            self.words |= {(bank, first + n) for n in range(self.share)}


async def play(dut, share):
    for seed, (spread, busy) in enumerate([(1 << ADDRESS, 0.3), (40, 0.2), (40, 0.7)]):
        rng, marked = random.Random(seed), Marked(dut, seed, share)
        await marked.start()
        for _ in range(600):
            drawn = {
                bank: rng.randrange(spread) for bank in range(CONFIG.banks) if rng.random() < busy
            }
            line = rng.randrange(LINES) if spread < 64 else rng.randrange(16)
            await marked.cycle(drawn, line, rng.randrange(STRETCHES), rng.random() < 0.3)
        assert marked.words
        for line in range(16):
            for stretch in range(STRETCHES):
                await marked.cycle({}, line, stretch, take=True)
        assert not marked.words
        for line in range(16):
            await marked.cycle({}, line, rng.randrange(STRETCHES), take=False)


@cocotb.test()
async def a_mark_a_word(dut):
    """Banks are drawn into anywhere, or close together; stretches are taken among it."""
    await play(dut, 1)


@cocotb.test()
async def a_mark_for_four(dut):
    """The same where words share their marks."""
    await play(dut, 4)


@pytest.mark.parametrize(("share", "test"), [(1, "a_mark_a_word"), (4, "a_mark_for_four")])
def test_marks_are_what_was_drawn(share, test):
    blocks.run_bench(BankMarks(WIDE.replace(mark_words=share)), __file__, test=test)


SHARED = next(config for config in ALL_OF_EIGHT if config.mark_words == 4)


@pytest.mark.parametrize(
    ("config", "test"),
    [(BANKS16, "a_mark_a_word"), (SHARED, "a_mark_for_four")],
    ids=["own", "shared"],
)
def test_marks_of_sixteen_banks(config, test):
    run_bench(config, BankMarks, __file__, test=test)
