"""The engine: code words in, raster out."""

from amaranth.hdl import Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.rtl.blocks.tiler import BlockTiler
from splatline.rtl.blocks.window import BlockWindow
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.front.tables import Tables
from splatline.rtl.shapes.rom import ROM_LATENCY, ShapeRom
from splatline.rtl.tiles.plane_depths import PlaneDepths
from splatline.rtl.tiles.tiler import Tiler
from splatline.rtl.tiles.window import TileWindow

from .layouts import CodeWordLayout, ElementLayout, RasterLayout, TableWriteLayout

__all__ = ["Engine", "engine_latency"]


def engine_latency(config: EngineConfig) -> int:
    """Return ``Engine(config).latency`` without building the engine."""
    latency = 8 if config.draws_blocks else 5 if config.plane else 4
    return latency + (ROM_LATENCY if config.shapes != "none" else 0)


class Engine(wiring.Component):
    """Draws frames of code words; the contract is ``docs/contract.md``.

    A frame opens with its first code word and closes with its end beat on ``raster``. The next
    frame may open right after the end word, while the last lines still leave. A table write waits
    until the open frames are closed, and no further frame opens while it is offered.

    **Latency**: 4 cycles from a code word to its pixels, 5 with planes, 8 with a window of blocks,
    and 3 more with a shape ROM. A line retires when a code word five or more lines below it
    follows, or the end word.
    **Throughput**: a window of blocks takes one code word a cycle, without hazards. A window of
    tiles takes one tile of ``pixels_per_word`` x 4 pixels a cycle: 1 to 4 cycles a code word with
    words of four pixels, up to 8 with two. A tile stalls for one cycle if it shares a pixel with
    the tile before it.

    Parameters
    ----------
    config
        Widths and sizes; see :class:`EngineConfig`.
    load
        Whether frames start from the raster on ``initial``. None: the control register decides.

    Members
    -------
    codewords : In(stream of CodeWordLayout)
        The frame, sorted by line.
    tables : In(stream of TableWriteLayout)
        Writes to the material table and the frame registers; they wait while a frame is open.
    initial : In(stream of RasterLayout)
        The initial raster. It is ignored if the control register's load bit is clear.
    raster : Out(stream of RasterLayout)
        The picture: the dirty words in order, then the end beat.
    in_frame : Out(1)
        Between the first code word of a frame and its end word.
    """

    @property
    def latency(self) -> int:
        """Cycles from the one that takes a code word to the one that writes its first pixels."""
        return engine_latency(self.config)

    @property
    def clear_cycles(self) -> int:
        """Cycles after reset in which the window's memory is cleared; code words wait."""
        return self.config.clear_cycles

    def __init__(self, config: EngineConfig = PAPER, *, load: bool | None = None):
        self.config = config
        self.load = load
        super().__init__(
            {
                "codewords": In(stream.Signature(CodeWordLayout(config))),
                "tables": In(stream.Signature(TableWriteLayout(config))),
                "initial": In(stream.Signature(RasterLayout(config))),
                "raster": Out(stream.Signature(RasterLayout(config))),
                "in_frame": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        m.submodules.tables = tables = Tables(config)
        m.submodules.sequencer = sequencer = Sequencer(config)
        m.submodules.colour = colour = ColourUnit(config)
        kinds = {"tiles": (Tiler, TileWindow), "blocks": (BlockTiler, BlockWindow)}
        tiler_of, window_of = kinds[config.window]
        m.submodules.tiler = tiler = tiler_of(config)
        m.submodules.window = window = window_of(config)

        connect(m, flipped(self.tables), tables.i)
        connect(m, flipped(self.codewords), sequencer.i)
        if config.shapes == "none":
            connect(m, sequencer.o, colour.i)
        else:
            # Behind the sequencer, which opens the frame and blocks table writes.
            m.submodules.shapes = shapes = ShapeRom(config, ElementLayout(config))
            connect(m, sequencer.o, shapes.i)
            connect(m, shapes.o, colour.i)
        connect(m, colour.o, tiler.i)
        shade = colour.shade
        if config.plane and not config.draws_blocks:
            m.submodules.depths = depths = PlaneDepths(config)
            connect(m, tiler.o, depths.i)
            connect(m, depths.o, window.i)
            m.d.comb += [tiler.ending.eq(depths.ending), depths.shade.eq(shade)]
            shade = depths.shaded
        else:
            connect(m, tiler.o, window.i)
        connect(m, flipped(self.initial), window.initial)
        connect(m, window.raster, flipped(self.raster))

        m.d.comb += [
            tiler.oldest.eq(window.oldest),
            colour.moves.eq(tiler.moves),
            window.shade.eq(shade),
        ]
        if config.draws_blocks:
            m.d.comb += [tiler.cleared.eq(window.cleared), tiler.empties.eq(window.empties)]

        # Open frames: at most one that leaves and one that is drawn.
        frames = Signal(2)
        unfinished = frames
        opens = Signal()
        waits = Signal()  # an offered element stays valid, even if a table write comes
        registers = tables.registers
        m.d.comb += opens.eq(self.codewords.valid & self.codewords.ready & ~sequencer.open)
        m.d.sync += [
            frames.eq(frames + opens - window.finished),
            waits.eq(sequencer.o.valid & ~sequencer.o.ready),
        ]
        if config.draws_blocks:
            # ``finished`` means that the end beat entered a fifo. It has not left the engine yet.
            unfinished = Signal(2)
            end_taken = self.raster.valid & self.raster.ready & self.raster.payload.end
            m.d.sync += unfinished.eq(unfinished + opens - end_taken)
        m.d.comb += [
            self.in_frame.eq(sequencer.open),
            # A write of the image size would change an end beat that waits.
            tables.idle.eq((unfinished == 0) & ~(self.raster.valid & self.raster.payload.end)),
            sequencer.admit.eq((~self.tables.valid | waits) & ~unfinished[1]),
            colour.ambient.eq(registers.ambient),
            colour.material.eq(tables.material),
            tiler.last_column.eq(registers.last_column),
            tiler.last_line.eq(registers.last_line),
            window.last_column.eq(registers.last_column),
            window.last_line.eq(registers.last_line),
            window.load.eq(registers.load if self.load is None else self.load),
            window.active.eq(frames[1] | (frames[0] & ~window.closing)),
        ]
        return m
