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
"""Beats that wait behind an engine. They lie in block RAM, of which more than a few take the same.

An engine that is dealt columns waits for those left of it to end their line, and sends its own
share of the line then: so the queue must hold some lines of that. With 32 beats two engines that
have 31 words in a line take 1.8 times as long.
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

    The picture is what one engine draws that is given the parts one after the other. The first
    engine starts from the background or from the raster on ``initial``, as an engine by itself.

    With the link ``merge`` each engine draws its part alone, from the background, and a
    :class:`Merger` joins its raster with that of those before it. That costs no cycle of any
    memory, and no engine waits for another one's lines. With ``load`` each engine loads what the
    one before sends into its own window and draws over it: less silicon, but a word takes an engine
    up to three cycles, and each engine stays eight lines behind the one before.

    Words in which nothing was drawn travel nowhere.

    **Frames**: they follow each other without a gap; an engine that is done goes on with the next
    frame while others are at the last one, but not with the one after that. Table writes go to all
    engines at once, when all are between the same two frames: a write that is offered waits for the
    frames that were begun, and lets no further one begin. An engine that is ready earlier is shown
    the same write until the others have it too, which changes nothing.

    **Deadlock**: there is none, as long as no part waits for another: whoever feeds the chain must
    offer the words of each stream whether or not another one's are taken. A merger that waits for
    its own engine has emptied that engine's queue, so the engine can send; one that waits for the
    link has emptied the link, so the merger before it can, or waits in turn. So of the engines that
    are not at the end of their frame one can always go on.

    **Latency**: that of an engine, 3 cycles for its queue, and 2 for each merger (or queue, with
    ``load``) behind. **Throughput**: all engines' together, but a word of the raster a cycle.

    Parameters
    ----------
    config
        The configuration of all engines.
    engines
        How many there are, 1 to 64.
    link
        One of ``LINKS``.
    queue
        Beats that may wait behind each engine, at least 2.
    place
        Called for each part with its kind and what makes it, it returns what is put there: the
        part, or something with its ports (:mod:`.chain_verilog`).

    Members
    -------
    codewords_0, codewords_1, ... : In(stream of CodeWordLayout)
        The engines' parts of the frame, each sorted by line and with an end word of its own.
    tables : In(stream of TableWriteLayout)
        Material table and frame registers of all engines; waits while a frame is open.
    initial : In(stream of RasterLayout)
        What the frame starts from, if the control register's load bit is set; else ignored.
    raster : Out(stream of RasterLayout)
        The picture: the words in which something was drawn, sorted; then the end beat.
    """

    # As an engine by itself, by its configuration alone: all draw and are cleared side by side.
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
        # Engines that have begun a frame that not all have: at most one frame lies between them.
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
                # It is kept from beginning a frame, but writes nothing before all do.
                engine.tables.payload.data.eq(self.tables.payload.data),
                engine.tables.payload.address.eq(Mux(all_idle, self.tables.payload.address, -1)),
                engine.tables.valid.eq(self.tables.valid & between),
            ]
