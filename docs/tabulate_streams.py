"""Write ``docs/streams.md``: widths, latencies and bit positions of every top and preset.

Run as ``.venv/bin/python docs/tabulate_streams.py [FILE]``. The definitions are those of the
hardware, the JSON beside the Verilog and the C header: ``contract/codeword_layout.py``,
``contract/beat_layout.py`` and ``contract/config.py``.
"""

import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

from amaranth.hdl import UnusedElaboratable

from splatline.contract.beat_layout import beat_fields, raster_stream_bytes
from splatline.contract.codeword_layout import codeword_fields, codeword_stream_bytes
from splatline.contract.fields import Register
from splatline.contract.presets import PRESETS
from splatline.flow.stream_texts import field_rows
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.narrow_top import BEAT_PIECE, WORD_PIECE, PinTop
from splatline.rtl.engine import Engine

HEAD = """\
# Ports in numbers

Made by `docs/tabulate_streams.py`. What the fields mean is in [the contract](contract.md); how the
ports work is in [the integration guide](integration.md). Bit 0 is the least significant. On a
stream of `--top engine` a word is the payload. On AXI it begins at bit 0 of TDATA, and the bits
above it are padding. On `--top pins` it comes in pieces, the lowest first.
"""

CHANNELS = ("red", "green", "blue")


def grouped(layout):
    """Return presets with the same layout together: lists of configurations."""
    groups = {}
    for config in PRESETS.values():
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
    yield "| preset | code word to pixels: engine | AXI | narrow | window cleared after reset |"
    yield "|---|---:|---:|---:|---:|"
    for config in PRESETS.values():
        cycles = [top(config).latency for top in (Engine, AxiTop, PinTop)]
        told = " | ".join(map(str, [*cycles, config.clear_cycles]))
        yield f"| `{config.name}` | {told} |"
    yield (
        "\nIn clock cycles, from the one that takes a code word, or its last piece, to the one that"
        "\nwrites its first pixels; nothing else waits."
    )


def words() -> Iterator[str]:
    """Yield the tables of code words and beats."""
    for title, layout in (("Code words", codeword_fields), ("Raster beats", beat_fields)):
        yield f"\n## {title}"
        for configs in grouped(layout):
            yield f"\n### {title} of {names(configs)}\n"
            yield "| bits | field | meaning |\n|---|---|---|"
            yield from field_rows(layout(configs[0]))


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
    return "\n".join((HEAD, *widths(), *words(), *tables())) + "\n"


if __name__ == "__main__":
    # Only their latencies are wanted.
    warnings.simplefilter("ignore", UnusedElaboratable)
    here = Path(__file__).parent / "streams.md"
    (Path(sys.argv[1]) if len(sys.argv) > 1 else here).write_text(page())
