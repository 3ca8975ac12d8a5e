"""Scan-out: reads the front buffer from SDRAM and shows it, centred, without tearing."""

from __future__ import annotations

from litedram.frontend.dma import LiteDRAMDMAReader
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from litex.soc.interconnect.csr import CSRStatus, CSRStorage
from migen import FSM, If, NextState, NextValue, Signal
from migen.genlib.cdc import MultiReg

from .compositor import Compositor

__all__ = ["ScanOut"]

CROSSING = 16
"""Pixels of the FIFO between the two clocks. The deep FIFO is that of the DMA."""


class ScanOut(LiteXModule):
    """Shows one of two frame buffers, and swaps them in vertical blank.

    In the first blank line of a refresh the reader stops and all FIFOs are emptied. Then the
    buffers are swapped if ``swap_valid`` is high, and the reader begins with the first visible
    pixel. So no refresh has pixels of two frames.

    A pixel that comes too late leaves the rest of its refresh background, and counts as an
    underrun; the next refresh is whole again.

    **Throughput**: one pixel a cycle of the memory port, as long as the memory gives it.

    Parameters
    ----------
    port
        A LiteDRAM port for reads, of 32 bits: one pixel a word.
    video_domain
        Clock domain of the pixels.
    depth
        Pixels that the reader has ahead of the screen.

    Attributes
    ----------
    timing
        Stream in, in the video domain: LiteX's timing generator.
    source
        Stream out, in the video domain: pixels for LiteX's PHY.
    swap_valid, swap_index : in
        A whole frame is in the buffer of this index, and waits to be shown.
    swapped : out
        High for one cycle: it is the front buffer from now on.
    shown : out
        There is a picture to show: the registers allow it, and there was a swap since reset.
    hungry : out
        The reader has less than three quarters of what it may have ahead: others keep away from
        the memory.
    refreshed : out
        High for one cycle at each start of a refresh, when a swap can take place.
    """

    def __init__(self, port, video_domain="hdmi", depth=1024):
        self.enable = CSRStorage(1, description="1: shows the picture; 0: background alone")
        self.left = CSRStorage(12, description="column of the screen of the first pixel")
        self.top = CSRStorage(12, description="line of the screen of the first pixel")
        self.columns = CSRStorage(12, description="visible columns")
        self.lines = CSRStorage(12, description="visible lines")
        self.offset = CSRStorage(32, description="bytes from a buffer to its first visible pixel")
        self.stride = CSRStorage(32, description="bytes from a line of a buffer to the next")
        self.buffer_0 = CSRStorage(32, description="byte address of buffer 0 in SDRAM")
        self.buffer_1 = CSRStorage(32, description="byte address of buffer 1 in SDRAM")
        self.background = CSRStorage(24, description="colour about the picture; red in bits 0..7")
        self.front = CSRStatus(1, description="the buffer that is shown")
        self.refreshes = CSRStatus(32, description="refreshes since reset; wraps")
        self.swaps = CSRStatus(32, description="swaps since reset; wraps")
        self.underruns = CSRStatus(32, description="refreshes that were not whole; wraps")
        self.swap_valid = Signal()
        self.swap_index = Signal()
        self.swapped = Signal()
        self.refreshed = Signal()
        self.shown = Signal()
        self.hungry = Signal()

        # # #

        self.compositor = compositor = Compositor(self, video_domain)
        self.timing, self.source = compositor.timing, compositor.source

        self.dma = dma = LiteDRAMDMAReader(port, fifo_depth=depth, fifo_buffered=True)
        self.crossing = stream.ClockDomainCrossing(
            [("data", 32)], cd_from="sys", cd_to=video_domain, depth=CROSSING
        )
        self.comb += [
            dma.source.connect(self.crossing.sink, keep={"ready", "data"}),
            # What comes late of an old refresh is dropped, also behind the line of the flush.
            self.crossing.sink.valid.eq(dma.source.valid & dma.enable),
            self.crossing.source.connect(compositor.pixels, keep={"valid", "ready", "data"}),
        ]
        self._read(dma, 3 * depth // 4)
        self._count(compositor)

    def _read(self, dma, enough):
        """Read the visible part of the front buffer once a refresh, line by line.

        The reader is hungry with less than ``enough`` pixels ahead.
        """
        flush = Signal()
        self.specials += MultiReg(self.compositor.flush, flush)
        pending = Signal(16)  # reads whose pixel has not left the FIFO
        asked, left = Signal(), Signal()
        front, whole = Signal(), Signal()
        start, begin = Signal(32), Signal(32)
        column, line = Signal(12), Signal(12)
        last_column, last_line = Signal(), Signal()
        self.comb += [
            asked.eq(dma.sink.valid & dma.sink.ready),
            left.eq(dma.source.valid & (dma.source.ready | ~dma.enable)),
            self.front.status.eq(front),
            self.shown.eq(self.enable.storage & whole),
            last_column.eq(column == self.columns.storage - 1),
            last_line.eq(line == self.lines.storage - 1),
        ]
        self.sync += [
            pending.eq(pending + asked - left),
            # Of the front buffer, ahead of its use.
            If(front, begin.eq(self.buffer_1.storage + self.offset.storage)).Else(
                begin.eq(self.buffer_0.storage + self.offset.storage)
            ),
        ]
        self.fsm = fsm = FSM(reset_state="FLUSH")
        fsm.act(
            "FLUSH",  # all that was read leaves the FIFOs
            dma.enable.eq(0),
            If(~flush & (pending == 0), self.refreshed.eq(1), NextState("SWAP")),
        )
        fsm.act(
            "SWAP",
            If(
                self.swap_valid & self.enable.storage,
                self.swapped.eq(1),
                NextValue(front, self.swap_index),
                NextValue(whole, 1),
            ),
            NextState("SETTLE"),
        )
        fsm.act("SETTLE", NextState("BEGIN"))  # `begin` is that of the new front buffer
        fsm.act(
            "BEGIN",
            NextValue(start, begin),
            NextValue(column, 0),
            NextValue(line, 0),
            If(self.shown, NextState("READ")).Else(NextState("REST")),
        )
        fsm.act(
            "READ",
            dma.sink.valid.eq(1),
            If(
                flush,
                NextState("FLUSH"),
            ).Elif(
                dma.sink.ready,
                NextValue(column, column + 1),
                If(
                    last_column,
                    NextValue(column, 0),
                    NextValue(line, line + 1),
                    NextValue(start, start + self.stride.storage),
                    If(last_line, NextState("REST")),
                ),
            ),
        )
        fsm.act("REST", If(flush, NextState("FLUSH")))
        self.comb += dma.sink.address.eq((start >> 2) + column)
        self.sync += self.hungry.eq(fsm.ongoing("READ") & (pending < enough))

    def _count(self, compositor):
        """Count refreshes, swaps and underruns."""
        self.sync += [
            If(self.refreshed, self.refreshes.status.eq(self.refreshes.status + 1)),
            If(self.swapped, self.swaps.status.eq(self.swaps.status + 1)),
            If(compositor.underrun, self.underruns.status.eq(self.underruns.status + 1)),
        ]
