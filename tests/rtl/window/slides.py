"""What the benches of both flush scans share: a window that slides down, and what is asked for."""

from splatline.sim.cosim.blocks import unpack
from splatline.sim.cosim.streams import StreamBench

__all__ = ["Slide"]


class Slide:
    """A flush scan with its sink; ``expected`` has the words (line, word) that are to be asked for.

    ``lowest`` is a line below every image, ``place`` the layout of what is asked for.
    """

    def __init__(self, dut, seed, rate, place, lowest):
        self.dut, self.place, self.lowest = dut, place, lowest
        self.bench = StreamBench(dut, seed)
        self.flush = self.bench.sink("flush", rate)
        self.expected = set()

    async def reset(self, inputs, port, rows):
        """Put inputs to 0, and clear all marks, a row of them a cycle: what ``port`` is set to."""
        dut = self.dut
        for name in inputs:
            getattr(dut, name).value = 0
        await self.bench.reset()
        dut.wipe.value = 1
        for row in rows:
            await self.bench.step(lambda row=row: setattr(port, "value", row))
        dut.wipe.value = 0

    def check_flush(self, oldest, top):
        """What is asked for now lies on the window's oldest line, above the next element."""
        if int(self.dut.flush__valid.value):
            line = unpack(self.place, int(self.dut.flush__payload.value)).line
            assert line == oldest < top

    async def leave(self, cycle):
        """Close the frame, let everything leave, in cycles of a kind, and some more; compare.

        Then another may begin.
        """
        dut = self.dut
        dut.close.value = 1
        for _ in range(60_000):
            await cycle()
            dut.close.value = 0
            if int(dut.over.value):
                break
        for _ in range(6):
            await cycle()
            assert int(dut.over.value) and int(dut.closing.value)
        asked = [place for bits in self.flush.received for place in self.words_of(bits)]
        assert asked == sorted(self.expected)
        dut.restart.value = 1
        await cycle()
        dut.restart.value = 0
        self.expected.clear()
        self.flush.received.clear()

    def words_of(self, bits):
        """Return the words (line, word) that are asked for at once, the left one first."""
        place = unpack(self.place, bits)
        return [(place.line, place.word)]
