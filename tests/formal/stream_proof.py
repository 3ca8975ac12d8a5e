"""What is offered on a stream stays until it is taken, on every stream that a component drives."""

from types import SimpleNamespace

from amaranth.hdl import Cat, Const, Mux, Signal, signed
from amaranth.lib.wiring import Out

from splatline.contract.config import BLOCK
from splatline.contract.presets import PAPER
from splatline.contract.register_map import register_map
from splatline.rtl.blocks.readout import BlockReadout
from splatline.rtl.bus.axi_lite import AxiLiteFront
from splatline.rtl.bus.axi_registers import RegisterFile
from splatline.rtl.bus.axi_stream import HalfSlice, RegisterSlice, ReverseSlice
from splatline.rtl.bus.codeword_check import end_word, is_end
from splatline.rtl.bus.narrow_top import Gatherer, Splitter
from splatline.rtl.bus.stream_guard import StreamGuard
from splatline.rtl.engine import Engine
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.layouts import CodeWordLayout
from splatline.rtl.shapes.rom import ShapeRom
from splatline.rtl.tiles.dirty_bits import RESIDUES
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.readout import TileReadout
from splatline.rtl.tiles.tiler import Tiler
from splatline.rtl.window.loader import Loader
from tests.formal.properties import SWIFT_NINE, OneWord, Properties, any_constant, parts
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]

NARROW = {
    "x_bits": 4,
    "line_bits": 5,
    "depth_bits": 8,
    "intensity_bits": 9,
    "material_bits": 9,
    "channel_bits": 1,
}
"""Engines of 16 columns: a whole one at full width takes ten times as long to write and to check,
and no rule of a stream depends on how wide it is."""


def streams(component):
    """Return the streams of a component by name: those that it takes, and those that it drives."""
    members = component.signature.members.items()
    found = {name: m for name, m in members if m.is_signature and "valid" in m.signature.members}
    taken = [name for name, member in found.items() if member.flow is not Out]
    return taken, [name for name in found if name not in taken]


class StreamProperties(Properties):
    """The rules of all streams of a component, given those of the streams that it takes.

    Parameters
    ----------
    component
        Makes the component.
    given
        ``given(properties, m, component)`` adds what its other inputs keep to; optional.
    polite
        Whether the streams that it takes keep their words.
    """

    def __init__(self, component, given=None, polite=True):
        self.component = component
        self.more = given
        self.polite = polite

    def describe(self, m):
        """Add the component and the rules."""
        self.memories = OneWord(Signal(1), apart=False)
        dut = self.component()
        self.fragment = self.add(m, dut)
        steady = ("last_column", "last_line", "last_word", "load", "enable")
        constants = {
            name: any_constant(m, dut.signature.members[name].shape, name)
            for name in steady
            if name in dut.signature.members and not isinstance(dut, TileFlushScan)
        }
        self.free(m, dut, **constants)
        taken, driven = streams(dut)
        for name in taken if self.polite else ():
            self.given(m, name, self.steady(m, getattr(dut, name), name))
        for name in driven:
            stream = getattr(dut, name)
            self.always(m, name, self.steady(m, stream, name))
        if self.more:
            self.more(self, m, dut)


def admitted(properties, m, dut):
    """A frame that may open while its first word waits still may in the next cycle."""
    waited = Signal()
    m.d.sync += waited.eq(dut.admit & dut.o.valid & ~dut.o.ready)
    properties.given(m, "admit", ~waited | dut.admit)


def window_stays(properties, m, dut):
    """The window does not move past a word that is offered, and its frame goes on.

    It does not move back during a frame. So nothing comes for the lines above ``limit``, which then
    does not fall but among lines that lie before the frame.
    """
    oldest, limit = Signal.like(dut.oldest), Signal.like(dut.limit)
    began, finished = Signal(init=1), Signal()
    m.d.sync += [oldest.eq(dut.oldest), began.eq(dut.restart)]
    m.d.sync += [limit.eq(dut.limit), finished.eq(dut.finished)]
    beat, lowest = dut.o.payload, -2 * dut.config.window_lines
    lines = dut.config.window_lines - (dut.config.window_lines > BLOCK)  # that are drawn into
    reaches = Signal(signed(len(dut.oldest) + 1))
    m.d.comb += reaches.eq(dut.oldest + lines)
    properties.given(m, "oldest", began | (oldest <= dut.oldest))
    inside = (dut.oldest >= lowest) & (dut.oldest <= 1 << dut.config.line_bits)
    properties.given(m, "inside", dut.finished | inside)
    properties.given(m, "begins", ~began | (dut.oldest <= 0))
    properties.given(m, "closes", ~dut.restart | dut.finished)
    properties.given(m, "stays", ~dut.o.valid | (dut.oldest <= dut.i.payload.line))
    properties.given(m, "active", ~dut.o.valid | (dut.active & ~dut.restart))
    properties.always(m, "limit", began | (limit <= dut.limit) | (limit <= 0))
    skip = dut.config.raster_words - 1
    properties.always(m, "open", ~dut.o.valid | ~(dut.finished | beat.end))
    comes = beat.line == dut.limit
    properties.always(m, "comes", ~dut.o.valid | (comes & (beat.line <= reaches)))
    within = (beat.line <= dut.last_line) & (beat.word[skip:] <= dut.last_word[skip:])
    kept = ~beat.end & within
    taken = dut.i.valid & dut.i.ready & kept & (beat.line >= dut.limit)
    properties.always(m, "kept", ~taken | dut.o.valid)
    properties.always(
        m,
        "front",
        dut.front == Mux(dut.finished, dut.oldest, dut.limit - lines),
    )
    properties.always(m, "reach", (dut.limit <= 0) | (dut.limit <= reaches))


def not_over(properties, m, dut):
    """One frame is closed at a time, and is over when nothing of it is asked for any more."""
    properties.given(m, "close", ~dut.close | ~dut.closing)
    properties.given(m, "restart", ~dut.restart | (dut.over & ~dut.flush.valid))


def within_reach(properties, m, dut):
    """And what is written may be, and lies on lines that do not leave."""
    not_over(properties, m, dut)
    properties.given(m, "reach", ~dut.touch.as_value().any() | (dut.reaching & ~dut.taking))
    properties.given(m, "load", ~dut.load.any() | (~dut.taking & ~dut.jump))
    properties.given(m, "one_load", (dut.load & (dut.load - 1)) == 0)
    for row in range(RESIDUES):
        ahead = Signal(dut.config.slot_bits, name=f"ahead_{row}")
        m.d.comb += ahead.eq(Cat(Const(row, 2), dut.group[row]) - dut.front)
        line = dut.front + ahead
        touched, loaded = dut.touch[row].any(), dut.load[row]
        properties.given(m, f"inside_{row}", ~(touched | loaded) | (line >= 0))
        properties.given(m, f"touch_{row}", ~touched | (line >= dut.top))
        properties.given(m, f"load_{row}", ~loaded | (line >= dut.limit))
        lone = dut.lone[row]  # as a load may need it, and a touch must not have it
        properties.given(m, f"apart_{row}", ~(touched & lone) & (lone | ~loaded))


def with_room(properties, m, dut):
    """A beat is asked for if there is room, and none at the end of a frame."""
    properties.given(m, "with_room", ~dut.flush | (dut.room & ~dut.end))


def while_running(properties, m, dut):
    """Nothing is requested while all stands still."""
    properties.given(m, "flush", ~dut.flush | dut.running)


def none_begins(properties, m, dut):
    """No frame begins while a table write waits."""
    waited = Signal()
    m.d.sync += waited.eq(dut.tables.valid & ~dut.tables.ready)
    properties.given(m, "busy", ~(waited & dut.busy))


def elements_stay(properties, m, dut):
    """What comes out of the sequencer stays as well, whatever tables are offered meanwhile."""
    (sequencer,) = parts(properties.fragment, Sequencer)
    properties.always(m, "element", properties.steady(m, sequencer.o, "element"))


def answers_stay(properties, m, dut):
    """The bus's two channels of answers are streams as well, whatever its master does."""
    none_begins(properties, m, dut)
    bus = dut.bus
    for name, payload in (("b", bus.bresp), ("r", Cat(bus.rdata, bus.rresp))):
        valid, ready = getattr(bus, f"{name}valid"), getattr(bus, f"{name}ready")
        channel = SimpleNamespace(payload=payload, valid=valid, ready=ready)
        properties.always(m, f"bus_{name}", properties.steady(m, channel, f"bus_{name}"))


def drops_nothing_open(properties, m, dut):
    """While the rest of a packet is dropped, no frame is open but one whose end is put in."""
    properties.lemma(m, "drops", ~(dut.dropping & dut.open) | dut.insert)


def plan(name, component, *faults, given=None, polite=True, depth=4, endless=True, **options):
    """Return the proof of a component's streams."""
    return Proof(
        name=f"streams: {name}",
        shows="what is offered stays, unchanged, until it is taken",
        build=lambda: StreamProperties(component, given, polite),
        depth=depth,
        endless=endless,
        faults=faults,
        **options,
    )


PROOFS = [
    plan(
        "sequencer",
        lambda: Sequencer(PAPER),
        Fault("counted too early", Sequencer, r"valid & self\.i\.ready\)", "valid)"),
        given=admitted,
    ),
    plan(
        "loader",
        lambda: Loader(PAPER),
        Fault("offered every other cycle", Loader, r"offered\.eq\(", "offered.eq(~offered & "),
        Fault(
            "limit a line too far", Loader, r"(limit\.eq\(Mux\(in_window, beat\.line)", r"\1 + 1"
        ),
        Fault(
            "a line too far below the window",
            Loader,
            r"lines, self\.oldest",
            "lines, self.oldest + 1",
        ),
        Fault("above the line before", Loader, r"beat\.line < self\.limit", "0"),
        Fault("front a line too far", Loader, r"oldest, loaded\)", "oldest, loaded + 1)"),
        given=window_stays,
    ),
    plan(
        "loader, beats of two words",
        lambda: Loader(SWIFT_NINE),
        Fault(
            "half outside, and dropped",
            Loader,
            r"beat\.word\[skip:\] > self\.last_word\[skip:\]",
            "beat.word > self.last_word",
        ),
        given=window_stays,
    ),
    plan(
        "loader, eight lines",
        lambda: Loader(PAPER.replace(window_lines=8)),
        Fault("a line drawn into too early", Loader, r"\(config\.window_lines > BLOCK\)", "1"),
        given=window_stays,
    ),
    plan(
        "flush scan",
        lambda: TileFlushScan(PAPER),
        Fault("next word unasked", TileFlushScan, r"If\(asked\)", "If(asking)", "_pairs"),
        given=within_reach,
        depth=10,
        endless=False,
    ),
    plan(
        "tiles: readout",
        lambda: TileReadout(PAPER),
        Fault("taken too early", TileReadout, r"~emit_valid \| self\.raster\.ready", "1"),
        given=while_running,
    ),
    plan(
        "blocks: readout",
        lambda: BlockReadout(SWIFT_NINE),
        Fault(
            "gone again", BlockReadout, r"blank\.eq\(out\.valid & ~visible", "blank.eq(out.valid"
        ),
        given=with_room,
        changes=(
            # The memory is a real one here; above 16 beats, as below 512, a register follows it.
            Fault("short", BlockReadout, r"m = Module\(\)", "m = Module(); DEPTH = 20"),
        ),
    ),
    plan(
        "tiler",
        lambda: Tiler(PAPER),
        Fault("taken too early", Tiler, r"step\.eq\(~valid \| self\.o\.ready\)", "step.eq(1)"),
    ),
    plan(
        "colour unit",
        lambda: ColourUnit(PAPER),
        Fault("taken too early", ColourUnit, r"step\.eq\(~valid \| self\.o\.ready\)", "step.eq(1)"),
    ),
    plan(
        "small shape ROM",
        lambda: ShapeRom(PAPER.with_shapes()),
        Fault("moved too early", ShapeRom, r"~valid\[2\] \| gone \| self\.o\.ready", "1"),
    ),
    plan(
        "full shape ROM",
        lambda: ShapeRom(PAPER.with_shapes("full")),
        Fault("moved too early", ShapeRom, r"~valid\[2\] \| gone \| self\.o\.ready", "1"),
    ),
    plan(
        "register slice",
        lambda: RegisterSlice(CodeWordLayout(PAPER)),
        Fault("taken too early", RegisterSlice, r"~valid \| self\.o\.ready", "1"),
        polite=False,
    ),
    plan(
        "half slice",
        lambda: HalfSlice(CodeWordLayout(PAPER)),
        Fault("dropped", HalfSlice, r"valid\.eq\(~self\.o\.ready\)", "valid.eq(0)"),
        polite=False,
    ),
    plan(
        "reverse slice",
        lambda: ReverseSlice(CodeWordLayout(PAPER)),
        Fault("overwritten", ReverseSlice, r"If\(~full\)", "If(1)"),
    ),
    plan(
        "stream guard",
        lambda: StreamGuard(CodeWordLayout(PAPER), end_word(PAPER), is_end),
        Fault("cut off", StreamGuard, r"Elif\(cut & ~passing\)", "Elif(cut)"),
        given=drops_nothing_open,
        changes=(
            Fault(
                "a register that the lemma looks at",
                StreamGuard,
                r"insert = ",
                "insert = self.insert = ",
            ),
        ),
    ),
    plan(
        "register file",
        lambda: RegisterFile(register_map(PAPER)),
        Fault("address overwritten", AxiLiteFront, r"bus\.awvalid & ~addressed", "bus.awvalid"),
        Fault("B taken too early", AxiLiteFront, r"answered & bus\.bready", "answered"),
        Fault("B overwritten", AxiLiteFront, r"addressed & given & ~answered", "addressed & given"),
        Fault("R taken too early", AxiLiteFront, r"told & bus\.rready", "told"),
        Fault("R overwritten", AxiLiteFront, r"asked & ~told", "asked"),
        given=answers_stay,
    ),
    plan(
        "gatherer",
        lambda: Gatherer(64, 16),
        Fault("not held", Gatherer, r"valid & ~full\)", "valid)"),
    ),
    plan(
        "splitter",
        lambda: Splitter(90, 18),
        Fault("not held", Splitter, r"room\.eq\(.*\)", "room.eq(1)"),
    ),
    plan(
        "engine with tiles",
        lambda: Engine(PAPER.replace(window_lines=8, **NARROW)),
        Fault("taken too early", TileReadout, r"~emit_valid \| self\.raster\.ready", "1"),
        Fault("a size while the end waits", Engine, r"0\) & ~\(self\.raster.*\)\)", "0))"),
        Fault("withdrawn for a table", Engine, r"\(~(self\.tables\.valid) \| waits\)", r"~\1"),
        given=elements_stay,
        depth=14,
        endless=False,
        engine="abc bmc3",
        slow=True,
    ),
]
