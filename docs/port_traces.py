"""Simulates an engine's tops and records their ports, cycle by cycle, for the timing diagrams.

``stream_rows.py``, ``bus_rows.py`` and ``framebuffer_rows.py`` have the tops. ``draw_waves.py``
draws what comes out, and ``tests/docs/test_waves.py`` checks what the page says of it.
"""

from dataclasses import dataclass, field

from amaranth.hdl import ResetInserter, Signal
from amaranth.sim import Simulator

__all__ = [
    "Constants",
    "Feed",
    "Sink",
    "axi_feed",
    "axi_sink",
    "signals",
    "stream_feed",
    "stream_sink",
    "top_taken",
    "trace",
]


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


class Constants:
    """Inputs that do not change."""

    def __init__(self, values):
        self.values = values

    def drive(self, ctx, rows):
        """Set them."""
        for signal, value in self.values:
            ctx.set(signal, value)

    def record(self, ctx):
        """Return nothing."""
        return {}


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


def signals(top, *names):
    """Return valid and ready of streams by name."""
    return {
        f"{name}.{wire}": getattr(getattr(top, name), wire)
        for name in names
        for wire in ("valid", "ready")
    }


def top_taken(rows, name):
    """Return the cycles in which a word of a stream is taken."""
    return [cycle for cycle, row in enumerate(rows) if row[f"{name}.taken"]]
