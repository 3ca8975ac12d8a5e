"""A lane of the tiles engine: one block RAM of pixels, and a depth comparison."""

from amaranth.hdl import Cat, Const, Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout

__all__ = ["Lane", "LaneRequestLayout", "lane_address_bits"]


def lane_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a lane: those of its lines, one in four, and of its columns."""
    return config.group_bits + config.word_bits


class LaneRequestLayout(data.StructLayout):
    """A request to a lane, at most one of three operations.

    ``draw``: depth-test the pixel at ``address``. ``clear``: read it and leave background there.
    ``load``: write a pixel there without a depth test. With simple memories a load is a ``clear``.
    """

    def __init__(self, config: EngineConfig):
        load = {"load": 1} if config.memory == "dual" else {}
        super().__init__({"draw": 1, "clear": 1, **load, "address": lane_address_bits(config)})


class Lane(wiring.Component):
    """Reads a pixel, compares depths, and writes the new pixel if it is nearer.

    The lane has one pixel of each word of every fourth line of the window. A memory word is one
    pixel, so a write need not merge anything with the old word.

    The pixel is read in the cycle of the request. In the next cycle it is on ``old`` and is
    compared with ``new``, and the write happens at the end of that cycle. Read-after-write hazard:
    a request for the same pixel in that cycle would read the old value, so the requester must stall
    for a cycle.

    A clear sets the depth to the background's and leaves the colour undefined.

    A load goes through the read port, which is otherwise unused in that cycle. It needs no
    multiplexer. The other port may write at the same time, but not the same pixel.

    With ``flush_words`` 2 one request clears a pair of pixels, of neighbouring words: the even one
    at once through the read port, the odd one in the next cycle through the write port. The read
    port may serve the next request in that cycle. Each port reads the pixel that it clears, so the
    block RAM must be read-first.

    With simple memories there is one port that writes. A clear writes ``new`` whatever is there, so
    a load is a clear whose ``new`` is the loaded pixel.

    **Latency**: 1 cycle to ``old``, 2 to the memory; for a load 1, or 2 with simple memories; of a
    pair 2 to ``odd``.
    **Throughput**: one request a cycle.

    Members
    -------
    enable : In(1)
        Low: the lane stalls and takes no ``request``.
    request : In(LaneRequestLayout)
        The request.
    new : In(PixelLayout)
        The pixel to draw, in the cycle after the request; with planes or simple memories, at the
        background's depth after a clear.
    loaded : In(PixelLayout)
        The pixel to load, in the cycle of the request; with ``flush_words`` 2 background at a
        clear. Not with simple memories.
    old : Out(PixelLayout)
        The pixel before the last request that was taken.
    odd : Out(PixelLayout)
        With ``flush_words`` 2: the odd pixel of a pair, two cycles after its request.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        self.pairs = config.flush_words == 2
        self.simple = config.memory == "simple"
        loaded = {} if self.simple else {"loaded": In(PixelLayout(config))}
        odd = {"odd": Out(PixelLayout(config))} if self.pairs else {}
        super().__init__(
            {
                "enable": In(1),
                "request": In(LaneRequestLayout(config)),
                "new": In(PixelLayout(config)),
                **loaded,
                "old": Out(PixelLayout(config)),
                **odd,
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        pixel = PixelLayout(config)
        m.submodules.ram = ram = memory.Memory(
            shape=pixel,
            depth=1 << lane_address_bits(config),
            init=[],
            # Nobody uses a pixel that was read while it was being written, but of a pair.
            attrs={"ram_style": "block", **({} if self.pairs else {"no_rw_check": 1})},
        )
        read, loads = ram.read_port(), [ram.write_port() for _ in range(not self.simple)]
        write = ram.write_port()
        taken = Signal(LaneRequestLayout(config))
        difference = Signal(config.depth_bits + 3)
        with m.If(self.enable):
            m.d.sync += taken.eq(self.request)
        m.d.comb += [read.addr.eq(self.request.address), read.en.eq(self.enable)]
        for load in loads:
            m.d.comb += [
                # Of the same address and enable, so that the two are one port of the block RAM.
                load.addr.eq(self.request.address),
                load.en.eq(self.enable & self.request.load),
                load.data.eq(self.loaded),
            ]
        old = Cat(self.old.depth, taken.draw, taken.clear)
        new = Cat(self.new.depth, Const(1, 2))
        m.d.comb += [
            self.old.eq(read.data),
            # new < old, as the carry of old - new - 1 or the borrow of new - old; the request rides
            # on the same chain, because the way from the memory to its own write enable is the
            # longest there is. Where each lane has a depth of its own, an adder whose operand is
            # inverted would take an inverter a bit.
            difference.eq(new - old if self.simple else old + ~new),
            write.addr.eq(taken.address),
            write.data.colour.eq(self.new.colour),
            write.data.depth.eq(
                self.new.depth
                if config.plane or self.simple
                else self.new.depth | taken.clear.replicate(config.depth_bits)
            ),
            # Written every cycle while standing still, the pixel comes out the same each time.
            write.en.eq(difference[-1]),
        ]
        if self.pairs:
            self._clear_pairs(m, ram, *loads, write, taken, difference[-1])
        return m

    def _clear_pairs(self, m, ram, load, write, taken, passes):
        """Clear two pixels at a request, one through each port, which reads it first."""
        request = self.request
        odd = ram.read_port()
        m.d.comb += [
            load.en.eq(self.enable & (request.load | request.clear)),
            odd.addr.eq(taken.address),
            odd.en.eq(self.enable),
            self.odd.eq(odd.data),
            # Once alone, however long all stands still: it would be read as it was written.
            write.en.eq(self.enable & passes),
        ]
        with m.If(self.enable):
            m.d.sync += taken.address[0].eq(request.address[0] | request.clear)
