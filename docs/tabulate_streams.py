"""Write ``docs/streams.md``: widths, latencies and bit positions of every top and preset.

Run as ``.venv/bin/python docs/tabulate_streams.py [FILE]``. The definitions are those of the
hardware, the JSON beside the Verilog and the C header: ``contract/codeword_layout.py``,
``contract/beat_layout.py`` and ``contract/config.py``. The frame buffer's ports are those of
``rtl/framebuffer/top.py``.
"""

import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

from amaranth.hdl import Shape, UnusedElaboratable
from amaranth.lib.wiring import In
from amaranth.sim import Simulator

from splatline.contract.beat_layout import beat_fields, raster_stream_bytes
from splatline.contract.codeword_layout import (
    codeword_fields,
    codeword_stream_bytes,
    compact_fields,
)
from splatline.contract.fields import Register
from splatline.contract.presets import DEFAULT, PRESETS
from splatline.contract.stream_layout import StreamField, padding_of
from splatline.flow.stream_texts import field_rows
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.narrow_top import BEAT_PIECE, WORD_PIECE, PinTop
from splatline.rtl.engine import Engine
from splatline.rtl.framebuffer.burst_writer import BurstWriter
from splatline.rtl.framebuffer.layouts import DATA_BITS, PIXEL_BYTES, bus_pixels
from splatline.rtl.framebuffer.top import FrameBufferTop

HEAD = """\
# Ports in numbers

Made by `docs/tabulate_streams.py`. What the fields mean is in [the contract](contract.md); how the
ports work is in [the integration guide](integration.md). Bit 0 is the least significant. On a
stream of `--top engine` a word is the payload. On AXI it begins at bit 0 of TDATA, and the bits
above it are padding. `--top framebuffer` has the streams of AXI, and a [bus](#the-frame-buffer) in
the place of the picture's stream. On `--top pins` a word comes in pieces, the lowest first. A chain
has the words of `--top engine`.
"""

CHANNELS = ("red", "green", "blue")


def grouped(layout, presets):
    """Return presets with the same layout together: lists of configurations."""
    groups = {}
    for config in presets:
        groups.setdefault(str(layout(config)), []).append(config)
    return list(groups.values())


def names(configs) -> str:
    """Return the names of configurations."""
    return ", ".join(f"`{config.name}`" for config in configs)


def widths() -> Iterator[str]:
    """Yield the table of the ports' widths."""
    yield "## Widths\n"
    yield (
        "| preset | code word | table write | beat | AXI: code words | AXI: rasters |"
        " narrow: words | narrow: beats |"
    )
    yield "|---|---:|---:|---:|---:|---:|---:|---:|"
    for config in PRESETS.values():
        widest = max(config.codeword_bits, config.table_address.end)
        pieces = -(-widest // WORD_PIECE), -(-config.raster_end.end // BEAT_PIECE)
        yield (
            f"| `{config.name}` | {config.codeword_bits} | {config.table_address.end} | "
            f"{config.raster_end.end} | {8 * codeword_stream_bytes(config)} | "
            f"{8 * raster_stream_bytes(config)} | {pieces[0]} x {WORD_PIECE} | "
            f"{pieces[1]} x {BEAT_PIECE} |"
        )
    yield "\nIn bits. Each piece of the narrow top's words has one bit more: 1 for a table write."
    yield "\n## Latencies\n"
    yield (
        "| preset | code word to pixels: engine | AXI | framebuffer | narrow |"
        " window cleared after reset |"
    )
    yield "|---|---:|---:|---:|---:|---:|"
    for config in PRESETS.values():
        cycles = [top(config).latency for top in (Engine, AxiTop, FrameBufferTop, PinTop)]
        told = " | ".join(map(str, [*cycles, config.clear_cycles]))
        yield f"| `{config.name}` | {told} |"
    yield (
        "\nIn clock cycles, from the one that takes a code word, or its last piece, to the one that"
        "\nwrites its first pixels; nothing else waits."
    )


def words(title, layout, presets, suffix="") -> Iterator[str]:
    """Yield a table of the fields of a word for each of its layouts."""
    for configs in grouped(layout, presets):
        yield f"\n### {title} of {names(configs)}{suffix}\n"
        yield "| bits | field | meaning |\n|---|---|---|"
        yield from field_rows(layout(configs[0]))


def codewords() -> Iterator[str]:
    """Yield the tables of code words and compact words."""
    presets = PRESETS.values()
    yield "\n## Code words"
    yield from words("Code words", codeword_fields, presets)
    yield "\n## Compact words\n"
    yield "Of an engine with a [shape ROM](contract.md#compact-words), as `paper-rom` is one."
    yield from words(
        "Compact words",
        lambda config: compact_fields(config.with_shapes()),
        [config for config in presets if not config.plane],
        " with a shape ROM",
    )


def beats() -> Iterator[str]:
    """Yield the tables of raster beats."""
    yield "\n## Raster beats"
    yield from words("Raster beats", beat_fields, PRESETS.values())


def steady_values(data_bits: int) -> dict[str, int]:
    """Return the values of the bus's wires that never change, by name: a simulation's first."""
    writer = BurstWriter(data_bits, 64, 8)
    steady = ("awid", "awsize", "awburst", "awlock", "awcache", "awprot", "awqos", "bready")
    values = {}

    async def bench(ctx):
        values.update({f"m_axi_{name}": ctx.get(getattr(writer.bus, name)) for name in steady})

    simulator = Simulator(writer)
    simulator.add_clock(1e-8)
    simulator.add_testbench(bench)
    simulator.run()
    return values


def frame_buffer() -> Iterator[str]:
    """Yield the tables of the frame buffer's ports."""
    tops = [FrameBufferTop(DEFAULT, bits).signature.members for bits in DATA_BITS]
    steady = [steady_values(bits) for bits in DATA_BITS]
    streams = AxiTop(DEFAULT).signature.members
    widths = ", ".join(map(str, DATA_BITS))
    yield "\n## The frame buffer\n"
    yield f"What `--top framebuffer` has beside AXI, with a bus of {widths} bits."
    yield "[Its page](framebuffer.md) says what the wires do.\n"
    yield "| signal | direction | bits | value, if it never changes |\n|---|---|---|---|"
    for name, member in tops[0].items():
        if name not in streams:
            bits = [str(Shape.cast(top[name].shape).width) for top in tops]
            value = [str(values[name]) for values in steady if name in values]
            cells = (", ".join(each if len(set(each)) > 1 else each[:1]) for each in (bits, value))
            yield f"| `{name}` | {'in' if member.flow is In else 'out'} | {' | '.join(cells)} |"
    yield "\n### Pixels on the bus\n"
    yield (
        f"A bus word has {', '.join(str(bus_pixels(bits)) for bits in DATA_BITS)} pixels, the"
        f" leftmost lowest. Pixel n begins at bit {8 * PIXEL_BYTES} n of WDATA and at bit"
        f" {PIXEL_BYTES} n of WSTRB.\n"
    )
    yield "| bits | field | meaning |\n|---|---|---|"
    fields = [StreamField(name, 8 * n, 8, 1, name) for n, name in enumerate(CHANNELS)]
    yield from field_rows([*fields, *padding_of(fields[-1].end, 8 * PIXEL_BYTES)])


def tables() -> Iterator[str]:
    """Yield the tables of table writes of `--top engine` and `--top pins`."""
    yield "\n## Table writes\n"
    yield "Of `--top engine` and `--top pins`. On AXI they are [registers](registers.md).\n"
    yield f"| field | {' | '.join(f'`{name}`' for name in PRESETS)} |"
    yield f"|---|{'---|' * len(PRESETS)}"
    rows = {"data": lambda c: c.table_data, "address": lambda c: c.table_address}
    for kind, coefficient in enumerate(("kd", "ks")):
        for channel, colour in enumerate(CHANNELS):
            rows[f"data of a material: {coefficient} {colour}"] = (
                lambda c, kind=kind, channel=channel: c.coefficient(kind, channel)
            )
    for name, place in rows.items():
        fields = [place(config) for config in PRESETS.values()]
        yield f"| {name} | {' | '.join(f'{f.lsb}..{f.end - 1}' for f in fields)} |"
    registers = {
        "materials": lambda c: f"0..{c.register_base - 1}",
        **{
            f"I0 of {colour}": lambda c, n=n: str(c.register_base + Register.AMBIENT_RED + n)
            for n, colour in enumerate(CHANNELS)
        },
        "last column": lambda c: str(c.register_base + Register.LAST_COLUMN),
        "last line": lambda c: str(c.register_base + Register.LAST_LINE),
        "control: bit 0 loads": lambda c: str(c.register_base + Register.CONTROL),
    }
    for name, address in registers.items():
        yield f"| address of {name} | {' | '.join(map(address, PRESETS.values()))} |"


def page() -> str:
    """Return the page."""
    return "\n".join((HEAD, *widths(), *codewords(), *beats(), *tables(), *frame_buffer())) + "\n"


if __name__ == "__main__":
    # Only their latencies are wanted.
    warnings.simplefilter("ignore", UnusedElaboratable)
    here = Path(__file__).parent / "streams.md"
    (Path(sys.argv[1]) if len(sys.argv) > 1 else here).write_text(page())
