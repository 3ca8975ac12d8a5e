"""The burst writer: bus words become AXI4 bursts."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.fifo import SyncFIFO, SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from splatline.rtl.bus.axi_write import AxiWriteSignature, Burst

from .layouts import PIXEL_BYTES, MemoryWordLayout, bus_pixels

__all__ = ["BURSTS", "BurstWriter"]

BURSTS = (2, 4, 8, 16, 32, 64, 128, 256)
"""Most beats of a burst."""

CACHE = 0b0011
"""AWCACHE: normal memory, bufferable, not cached."""


class BurstWriter(wiring.Component):
    """Gathers words in a FIFO, and writes them in bursts of type INCR.

    A burst ends at the end of a line, and before an address that is a multiple of ``burst`` words.
    So it has at most ``burst`` beats and never crosses 4 KB. Its address is offered once its last
    word is in the FIFO, and so is its first word: after that no channel waits for the engine. All
    bursts have ID 0, and their data leave in order. Responses are always taken.

    **Latency**: 1 cycle from a burst's last word to its address, and 2 to its first beat.
    **Throughput**: a word a cycle while fewer than ``outstanding`` bursts wait for their response.

    Parameters
    ----------
    data_bits
        Bits of WDATA.
    burst
        Most beats of a burst: a power of two in 2..256.
    outstanding
        Most bursts without a response.

    Members
    -------
    words : In(stream of MemoryWordLayout)
        The words.
    last_pixels : In(pixels)
        Which pixels of a line's last word are written.
    bus : Out(AxiWriteSignature)
        The bus.
    idle : Out(1)
        No word waits, and no response.
    failed : Out(1)
        A response in this cycle is an error.
    """

    def __init__(self, data_bits: int, burst: int, outstanding: int):
        self.data_bits, self.burst, self.outstanding = data_bits, burst, outstanding
        super().__init__(
            {
                "words": In(stream.Signature(MemoryWordLayout(data_bits))),
                "last_pixels": In(bus_pixels(data_bits)),
                "bus": Out(AxiWriteSignature(data_bits)),
                "idle": Out(1),
                "failed": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        bus = self.bus
        pending = Signal(range(self.outstanding + 1))  # bursts without a response
        begun = Signal()  # a burst has a word, and no end yet
        take = Signal()
        close = Signal()
        answer = Signal()
        m.submodules.data = fifo = SyncFIFOBuffered(
            width=len(self.words.payload.rgb.as_value()) + 2, depth=2 * self.burst
        )
        m.d.comb += [
            self.words.ready.eq(fifo.w_rdy & (pending != self.outstanding)),
            take.eq(self.words.valid & self.words.ready),
            bus.bready.eq(1),
            answer.eq(bus.bvalid),
            self.idle.eq(~begun & (pending == 0)),
            self.failed.eq(answer & bus.bresp[1]),
        ]
        with m.If(close != answer):
            m.d.sync += pending.eq(Mux(close, pending + 1, pending - 1))
        with m.If(take):
            m.d.sync += begun.eq(~close)
        self._addresses(m, take, close, begun)
        self._data(m, fifo, take, close)
        return m

    def _addresses(self, m, take, close, begun):
        """End bursts, and queue their addresses."""
        bus, word = self.bus, self.words.payload
        bits = (self.burst - 1).bit_length()
        index = word.address[:bits]
        start = Signal(bits, reset_less=True)
        first = Signal(bits)
        m.d.comb += [
            first.eq(Mux(begun, start, index)),
            close.eq(take & (word.last | index.all())),
        ]
        with m.If(take):
            m.d.sync += start.eq(first)
        # Its words are read without a clock: too few for a block RAM.
        m.submodules.addresses = queue = SyncFIFO(
            width=bits + len(word.address), depth=self.outstanding
        )
        byte_bits = (self.data_bits // 8 - 1).bit_length()
        address, length = queue.r_data[bits:], queue.r_data[:bits]
        m.d.comb += [
            queue.w_data.eq(Cat((index - first)[:bits], first, word.address[bits:])),
            queue.w_en.eq(close),
            queue.r_en.eq(bus.awready),
            bus.awvalid.eq(queue.r_rdy),
            bus.awaddr.eq(address << byte_bits),
            bus.awlen.eq(length),
            bus.awsize.eq(byte_bits),
            bus.awburst.eq(Burst.INCR),
            bus.awcache.eq(CACHE),
        ]

    def _data(self, m, fifo, take, close):
        """Queue words, and send those of bursts that have ended."""
        bus, word = self.bus, self.words.payload
        closed = Signal()
        bursts = Signal(range(self.outstanding + 1))  # whole ones in the FIFO
        sent = Signal()
        partial, last = fifo.r_data[-2], fifo.r_data[-1]
        m.d.sync += closed.eq(close)
        with m.If(closed != sent):
            m.d.sync += bursts.eq(Mux(closed, bursts + 1, bursts - 1))
        m.d.comb += [
            fifo.w_data.eq(Cat(word.rgb, word.last, close)),
            fifo.w_en.eq(take),
            fifo.r_en.eq(bus.wvalid & bus.wready),
            bus.wvalid.eq(fifo.r_rdy & (bursts != 0)),
            bus.wlast.eq(last),
            sent.eq(bus.wvalid & bus.wready & last),
        ]
        for pixel in range(bus_pixels(self.data_bits)):
            written = ~partial | self.last_pixels[pixel]
            m.d.comb += [
                bus.wdata.word_select(pixel, 8 * PIXEL_BYTES).eq(fifo.r_data[24 * pixel :][:24]),
                bus.wstrb.word_select(pixel, PIXEL_BYTES).eq(written.replicate(PIXEL_BYTES)),
            ]
