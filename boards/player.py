"""Player: sends the code words of frames that lie in SDRAM, one frame after another."""

from __future__ import annotations

from litedram.frontend.dma import LiteDRAMDMAReader
from litex.gen import LiteXModule
from litex.soc.interconnect import stream, wishbone
from litex.soc.interconnect.csr import CSRStatus, CSRStorage
from migen import FSM, READ_FIRST, If, Memory, NextState, NextValue, Signal

__all__ = ["MOST_FRAMES", "Player"]

MOST_FRAMES = 256
"""Frames of the list."""


class Player(LiteXModule):
    """Plays a list of frames; each begins after the swap of the one before.

    The list is a memory on the bus: of each frame the byte address of its code words in SDRAM, and
    the number of 32-bit words there. A frame that has begun is sent whole, whatever the registers
    say meanwhile.

    **Throughput**: 32 bits a cycle of the memory port, as long as the memory gives them.

    Parameters
    ----------
    port
        A LiteDRAM port for reads, of 32 bits.
    word_bits
        Bits of a word of the stream out: 64, or 128 for plane words.
    depth
        32-bit words that the reader has ahead of the engine.

    Attributes
    ----------
    source
        Stream out: ``data``, and ``last`` with a frame's last word.
    bus
        Wishbone: the list.
    swapped, refreshed, pause : in
        From :class:`splatline.boards.scanout.ScanOut`; ``pause`` is its ``hungry``.
    """

    def __init__(self, port, word_bits, depth=128):
        self.enable = CSRStorage(1, description="1: plays; 0: ends after the frame that it sends")
        self.loop = CSRStorage(1, description="1: after the last frame comes the first one again")
        self.frames = CSRStorage(9, description="frames of the list")
        self.hold = CSRStorage(8, description="refreshes, after its swap, before the next begins")
        self.busy = CSRStatus(1, description="a frame is sent, or waits for its swap")
        self.played = CSRStatus(32, description="frames that were shown since reset; wraps")
        self.swapped = Signal()
        self.refreshed = Signal()
        self.pause = Signal()

        # # #

        self.dma = dma = LiteDRAMDMAReader(port, fifo_depth=depth, fifo_buffered=True)
        self.words = words = stream.Converter(32, word_bits)
        self.source = words.source
        self.comb += dma.source.connect(words.sink, keep={"valid", "ready", "data", "last"})

        memory = Memory(32, 2 * MOST_FRAMES)
        entry = memory.get_port(mode=READ_FIRST)
        self.specials += memory, entry
        self.list = wishbone.SRAM(memory, bus=wishbone.Interface(data_width=32, addressing="word"))
        self.bus = self.list.bus
        self._play(dma, entry)

    def _play(self, dma, entry):
        """Fetch a frame's entry, read its words, wait for its swap."""
        frame, held = Signal(9), Signal(8)
        address, left = Signal(32), Signal(32)
        self.fsm = fsm = FSM(reset_state="IDLE")
        self.comb += [
            self.busy.status.eq(~fsm.ongoing("IDLE")),
            dma.sink.address.eq(address),
            dma.sink.last.eq(left == 1),
        ]
        fsm.act(
            "IDLE",
            NextValue(frame, 0),
            If(self.enable.storage & (self.frames.storage != 0), NextState("ENTRY")),
        )
        fsm.act("ENTRY", entry.adr.eq(frame << 1), NextState("WORDS"))
        fsm.act(
            "WORDS",
            entry.adr.eq((frame << 1) | 1),
            NextValue(address, entry.dat_r >> 2),
            NextState("LENGTH"),
        )
        fsm.act("LENGTH", NextValue(left, entry.dat_r), NextState("SEND"))
        fsm.act(
            "SEND",
            dma.sink.valid.eq((left != 0) & ~self.pause),
            If(
                dma.sink.ready & dma.sink.valid,
                NextValue(address, address + 1),
                NextValue(left, left - 1),
            ),
            If(left == 0, NextState("SHOW")),
        )
        fsm.act(
            "SHOW",
            NextValue(held, 0),
            If(
                self.swapped,
                NextValue(self.played.status, self.played.status + 1),
                NextValue(frame, frame + 1),
                NextState("HOLD"),
            ),
        )
        fsm.act(
            "HOLD",
            If(self.refreshed, NextValue(held, held + 1)),
            If(
                ~self.enable.storage,
                NextState("IDLE"),
            ).Elif(
                held >= self.hold.storage,
                If(
                    frame < self.frames.storage,
                    NextState("ENTRY"),
                )
                .Elif(
                    self.loop.storage,
                    NextValue(frame, 0),
                    NextState("ENTRY"),
                )
                .Else(NextState("DONE")),
            ),
        )
        fsm.act("DONE", If(~self.enable.storage, NextState("IDLE")))
