"""A chain of engines that draw one picture together."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.chain_links import LINKS, MOST_ENGINES
from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.rtl.engine import Engine
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout
from splatline.rtl.lib.fifo import Fifo

from .merger import Merger

__all__ = ["QUEUE", "Chain", "check_chain"]

QUEUE = 256
"""Beats in the fifo behind an engine. They fill the block RAMs that even a few beats would take.

An engine with a partition of columns sends its part of a line when the engines left of it have
ended the line, so the fifo must hold its parts of some lines. With 32 beats, two engines that have
31 words in a line take 1.8 times as long.
"""

Place = Callable[[str, Callable[[], wiring.Component]], wiring.Component]


def check_chain(engines: int, link: str, queue: int = QUEUE) -> None:
    """Raise ``ValueError`` for a chain that cannot be built; the parameters are those of Chain."""
    if not isinstance(engines, int) or not 1 <= engines <= MOST_ENGINES:
        raise ValueError(f"a chain has 1 to {MOST_ENGINES} engines, not {engines!r}")
    if link not in LINKS:
        raise ValueError(f"the link must be one of {', '.join(LINKS)}, not {link!r}")
    if not isinstance(queue, int) or queue < 2:
        raise ValueError(f"a queue holds at least 2 beats, not {queue!r}")


class Chain(wiring.Component):
    """Engines side by side, each with a part of the frame's elements and all with the same tables.

    The picture is the same as if one engine drew the parts one after the other. The first engine
    starts from the background or from the raster on ``initial``, like a single engine.

    With the link ``merge`` each engine draws its part from the background, and a :class:`Merger`
    joins its raster with that of the engines before it. This takes no memory cycles, and no engine
    waits for another one's lines. With ``load`` each engine loads the raster of the engine before
    it into its own window and draws over it. This needs less logic, but a word takes an engine up
    to three cycles, and each engine stays eight lines behind the one before it.

    Only dirty words are sent.

    **Frames** follow each other without a gap. An engine may begin the next frame while others draw
    the present one, but not the frame after that. Table writes go to all engines at once, when all
    are between the same two frames. A write that is offered waits for the open frames and lets no
    further one begin. An engine that is ready earlier sees a write to an unused address until all
    are ready.

    **Deadlock**: none, if the streams of code words are independent: the source must offer the
    words of each stream whether or not another one's are taken. A merger that waits for its own
    engine has emptied that engine's fifo, so the engine can send. A merger that waits for the link
    has emptied the link, so the merger before it can send, or waits in turn. At least one engine
    that is not at the end of its frame can therefore always advance.

    **Latency**: that of an engine, 3 cycles for its fifo, and 2 for each merger behind it (or fifo,
    with ``load``). **Throughput**: the sum of the engines', but one raster word a cycle.

    Parameters
    ----------
    config
        The configuration of all engines.
    engines
        Number of engines, 1 to 64.
    link
        One of ``LINKS``.
    queue
        Beats in the fifo behind each engine, at least 2.
    place
        Function that is called for each part with its kind and its constructor. It returns the
        part, or a component with the same ports (:mod:`splatline.flow.chain_verilog`).

    Members
    -------
    codewords_0, codewords_1, ... : In(stream of CodeWordLayout)
        The engines' parts of the frame, each sorted by line and with an end word of its own.
    tables : In(stream of TableWriteLayout)
        Writes to the tables of all engines; they wait while a frame is open.
    initial : In(stream of RasterLayout)
        The initial raster. It is ignored if the control register's load bit is clear.
    raster : Out(stream of RasterLayout)
        The picture: the dirty words in order, then the end beat.
    """

    # The engines work in parallel, so these are the same as for a single engine.
    latency = Engine.latency
    clear_cycles = Engine.clear_cycles

    def __init__(
        self,
        config: EngineConfig = PAPER,
        engines: int = 2,
        link: str = "merge",
        *,
        queue: int = QUEUE,
        place: Place = lambda kind, make: make(),
    ):
        check_chain(engines, link, queue)
        self.config = config
        self.engines = engines
        self.link = link
        self.queue = queue
        self._place = place
        codewords = stream.Signature(CodeWordLayout(config))
        super().__init__(
            {
                **{f"codewords_{n}": In(codewords) for n in range(engines)},
                "tables": In(stream.Signature(TableWriteLayout(config))),
                "initial": In(stream.Signature(RasterLayout(config))),
                "raster": Out(stream.Signature(RasterLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        merges = self.link == "merge"
        engines = []
        for n in range(self.engines):
            kind = "first" if n == 0 else "engine"
            make = partial(Engine, self.config, load=None if n == 0 else not merges)
            engines.append(self._place(kind, make))
            m.submodules[f"engine_{n}"] = engines[n]
        connect(m, flipped(self.initial), engines[0].initial)
        self._frames(m, engines)

        picture = None  # of the engines so far
        for n, engine in enumerate(engines):
            if n and not merges:
                connect(m, picture, engine.initial)
            make = partial(Fifo, self.config, self.queue)
            m.submodules[f"queue_{n}"] = queue = self._place("queue", make)
            connect(m, engine.raster, queue.i)
            if n and merges:
                make = partial(Merger, self.config)
                m.submodules[f"merger_{n}"] = merger = self._place("merger", make)
                connect(m, picture, merger.before)
                connect(m, queue.o, merger.own)
                picture = merger.o
            else:
                picture = queue.o
        connect(m, picture, flipped(self.raster))
        return m

    def _frames(self, m, engines):
        """Let engines begin frames, and table writes between them."""
        # Engines that are one frame ahead of the slowest.
        ahead = Signal(len(engines))
        begins = Signal(len(engines))
        between = Signal()
        m.d.comb += between.eq(~ahead.any())
        with m.If((ahead | begins).all()):
            m.d.sync += ahead.eq(0)
        with m.Else():
            m.d.sync += ahead.eq(ahead | begins)

        idle = Signal(len(engines))
        all_idle = Signal()
        m.d.comb += [all_idle.eq(idle.all()), self.tables.ready.eq(between & all_idle)]
        for n, engine in enumerate(engines):
            words = getattr(self, f"codewords_{n}")
            may = Signal(name=f"may_{n}")
            m.d.comb += [
                idle[n].eq(engine.tables.ready),
                may.eq(engine.in_frame | ~ahead[n]),
                begins[n].eq(words.valid & words.ready & ~engine.in_frame),
                engine.codewords.payload.eq(words.payload),
                engine.codewords.valid.eq(words.valid & may),
                words.ready.eq(engine.codewords.ready & may),
                # The write keeps the engine from opening a frame. Its address is unused until all
                # engines are idle.
                engine.tables.payload.data.eq(self.tables.payload.data),
                engine.tables.payload.address.eq(Mux(all_idle, self.tables.payload.address, -1)),
                engine.tables.valid.eq(self.tables.valid & between),
            ]
