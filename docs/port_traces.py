"""Simulates an engine's tops and records their ports, cycle by cycle, for the timing diagrams.

``draw_waves.py`` draws what comes out, and ``tests/docs/test_waves.py`` checks what the page says
of it.
"""

from dataclasses import dataclass, field

from amaranth.hdl import ResetInserter, Signal
from amaranth.sim import Simulator

from splatline.contract.fields import Register
from splatline.contract.presets import PAPER
from splatline.host.encode.sort_by_line import advance_word, end_word

__all__ = ["Feed", "Sink", "axi_feed", "axi_sink", "elements", "table_writes", "trace"]

CONFIG = PAPER
LINES = 24


@dataclass
class Feed:
    """Words that are offered one after the other, each until it is taken.

    ``words`` has pairs of a label and a number. ``when`` tells from the rows so far whether to go
    on.
    """

    name: str
    valid: Signal
    ready: Signal
    payload: object
    words: list
    when: object = lambda rows: True
    also: list = field(default_factory=list)  # more signals, set to a word's further numbers
    index: int = 0
    held: bool = False

    def drive(self, ctx, rows):
        """Offer the next word."""
        # Nothing is offered in the first cycle, that of the reset.
        more = self.index < len(self.words) and len(rows) > 0
        offered = more and (self.held or self.when(rows))
        ctx.set(self.valid, int(offered))
        if offered:
            _, *numbers = self.words[self.index]
            for signal, number in zip([self.payload, *self.also], numbers, strict=True):
                ctx.set(signal, number)

    def record(self, ctx):
        """Return the label, or None, and whether the word is taken."""
        if not ctx.get(self.valid):
            return {self.name: None, f"{self.name}.taken": 0}
        taken = ctx.get(self.ready)
        label = self.words[self.index][0]
        self.index += taken
        self.held = not taken
        return {self.name: label, f"{self.name}.taken": taken}


@dataclass
class Sink:
    """A stream that is taken, but not while ``waits(cycle)``; ``label`` names a payload."""

    name: str
    valid: Signal
    ready: Signal
    payload: object
    label: object
    waits: object = lambda cycle: False

    def drive(self, ctx, rows):
        """Be ready, or not."""
        ctx.set(self.ready, int(not self.waits(len(rows))))

    def record(self, ctx):
        """Return the label of what is offered, or None, and whether it is taken."""
        if not ctx.get(self.valid):
            return {self.name: None, f"{self.name}.taken": 0}
        return {
            self.name: self.label(ctx.get(self.payload)),
            f"{self.name}.taken": ctx.get(self.ready),
        }


def trace(top, parts, watch, cycles, *, clock=None, reset=None):
    """Return a row for each clock cycle: value of each watched signal, label of each stream.

    Parameters
    ----------
    top
        The component.
    parts
        Feeds and sinks.
    watch
        Signals by name.
    cycles
        Number of rows.
    clock, reset
        The component's own clock, and its reset, which is low for the first cycle. None: those of
        the domain ``sync``; the reset is then a row ``rst``, high in the first cycle.
    """
    rst = Signal(init=1)
    simulator = Simulator(top if clock is not None else ResetInserter(rst)(top))
    rows = []

    async def bench(ctx):
        for cycle in range(cycles):
            ctx.set(rst if clock is None else reset, int((cycle == 0) == (clock is None)))
            for part in parts:
                part.drive(ctx, rows)
            row = {name: ctx.get(signal) for name, signal in watch.items()}
            if clock is None:
                row["rst"] = ctx.get(rst)
            for part in parts:
                row |= part.record(ctx)
            rows.append(row)
            if clock is None:
                await ctx.tick()
            else:
                ctx.set(clock, 1)
                await ctx.delay(5e-9)
                ctx.set(clock, 0)
                await ctx.delay(5e-9)

    if clock is None:
        simulator.add_clock(10e-9)
    simulator.add_testbench(bench)
    simulator.run()
    return rows


def elements(count):
    """Return a frame's code words with labels: elements on lines 4 and 16, and the end word."""
    rows = [(0, 7)] * 4

    def element(x, z, wide):
        scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(wide))
        fields = ((0, CONFIG.mode), (scans, CONFIG.scans), (x, CONFIG.x), (z, CONFIG.z))
        return sum(value << place.lsb for value, place in fields)

    words = [("+4", advance_word(4, CONFIG))]
    words += [(f"e{n}", element(3 + 4 * n, 100 - n, rows)) for n in range(count)]
    words += [("+12", advance_word(12, CONFIG)), (f"e{count}", element(4, 7, [(2, 5)] * 4))]
    return [*words, ("end", end_word(CONFIG))]


def table_writes(load=0):
    """Return table writes with labels: a material, the size of the image, what it starts from."""
    base = CONFIG.register_base
    writes = {
        "mat 0": (0, 0o777777),
        "col": (base + Register.LAST_COLUMN, 15),
        "line": (base + Register.LAST_LINE, LINES - 1),
        "ctl": (base + Register.CONTROL, load),
    }
    shift = CONFIG.table_address.lsb
    return [(name, address << shift | value) for name, (address, value) in writes.items()]


def beat_label(beat):
    """Return line and word of a beat, or ``end``."""
    if beat >> CONFIG.raster_end.lsb & 1:
        return "end"
    line = beat >> CONFIG.raster_line.lsb & CONFIG.raster_line.mask
    return f"{line}:{beat >> CONFIG.raster_word.lsb & CONFIG.raster_word.mask}"


def stream_feed(top, name, words, **options):
    """Return a feed of one of a component's streams."""
    port = getattr(top, name)
    payload = port.payload.as_value() if hasattr(port.payload, "as_value") else port.payload
    return Feed(name, port.valid, port.ready, payload, words, **options)


def stream_sink(top, name, label, **options):
    """Return a sink of one of a component's streams."""
    port = getattr(top, name)
    payload = port.payload.as_value() if hasattr(port.payload, "as_value") else port.payload
    return Sink(name, port.valid, port.ready, payload, label, **options)


def axi_feed(top, name, words, **options):
    """Return a feed of an AXI stream; a word has a label, TDATA and TLAST."""
    wire = {part: getattr(top, f"{name}_{part}") for part in ("tvalid", "tready", "tdata", "tlast")}
    return Feed(
        name, wire["tvalid"], wire["tready"], wire["tdata"], words, also=[wire["tlast"]], **options
    )


def axi_sink(top, name, label, **options):
    """Return a sink of an AXI stream."""
    wires = [getattr(top, f"{name}_{part}") for part in ("tvalid", "tready", "tdata")]
    return Sink(name, *wires, label, **options)
