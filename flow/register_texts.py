"""The register map as a C header, as JSON and as a page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from splatline.contract.register_map import raster_stream_bytes
from splatline.contract.register_types import Access, BusField, RegisterMap

__all__ = ["c_header", "json_map", "markdown"]

ACCESSES = {
    Access.READ_ONLY: "read only",
    Access.READ_WRITE: "read and write",
    Access.CLEAR: "a written 1 clears it, unless the hardware sets it in that cycle",
    Access.WRITE_ONLY: "write only, a read is refused",
}


PROSE = """
## Streams
| port | bytes of TDATA | a packet is |
|---|---:|---|
| `s_axis_codewords` | 8 | the code words of a frame; TLAST with the end word |
| `s_axis_initial` | {size} | the raster that a frame starts from; TLAST with the end beat |
| `m_axis_raster` | {size} | the picture's beats; TLAST with the end beat |

A beat has {beat} bits ([`contract.md`](contract.md)) and is filled up with zeros. Every packet of
code words is answered by one of the raster, which has at least the end beat.

A packet that is no frame sets a bit of ERROR and becomes a frame all the same. TLAST before the
end: an end is put in. An end before TLAST: the rest of the packet is dropped. TKEEP not all ones:
the word is dropped, and its TLAST counts. An initial raster that no frame asked for waits for one
that does.

## Order

Tables, size and START are written between frames, then the packets are sent. FRAME_DONE comes with
the end beat. STATUS.BUSY is 0 by then, unless a further packet has begun. A host that sends ahead
sets CONTROL.HOLD, waits for BUSY to fall, writes, and clears it.

CONTROL.ABORT ends the frame that is open: the rest of its packets is dropped up to TLAST, of
its picture only the end beat still leaves, and the tables stay. If the rest of a packet will never
come, because the host's DMA was reset, write RESYNC after it.

## Answers of the bus

Whatever is refused changes nothing and sets a bit of ERROR. The answer is DECERR where nothing is
and SLVERR elsewhere, and such a read gives 0. A write is of all four bytes: one whose WSTRB is not
all ones is refused. The two lowest bits of an address are not looked at. With CONTROL.QUIET every
answer is OKAY, because on many processors an error of the bus ends the program. The bits of ERROR
tell all the same.
"""


def c_header(registers: RegisterMap) -> str:
    """Return the map as a header for C99 that needs no other.

    For each register ``SPLATLINE_NAME_OFFSET``, in bytes; for each field ``_MASK``, ``_SHIFT`` and
    ``_RESET``. ``SPLATLINE_GET`` and ``SPLATLINE_PUT`` take a field out of a word and put it in.
    """
    lines = [
        f"/* Registers of a Splatline engine, preset {registers.config.name}.",
        f" * Made by: splatline registers --preset {registers.config.name} --c-header FILE */",
        "#ifndef SPLATLINE_REGISTERS_H",
        "#define SPLATLINE_REGISTERS_H",
        "",
        "/* A field of a word, and a word of a field: SPLATLINE_GET(STATUS_BUSY, word). */",
        "#define SPLATLINE_GET(field, word) \\",
        "    (((word) & SPLATLINE_##field##_MASK) >> SPLATLINE_##field##_SHIFT)",
        "#define SPLATLINE_PUT(field, value) \\",
        "    (((value) << SPLATLINE_##field##_SHIFT) & SPLATLINE_##field##_MASK)",
        "",
        f"#define SPLATLINE_BYTES {1 << registers.address_bits:#x}u",
    ]
    for register in registers.registers:
        lines += ["", f"/* {register.name}: {register.meaning}. */"]
        lines.append(f"#define SPLATLINE_{register.name}_OFFSET {register.offset:#06x}u")
        for field in register.fields:
            name = f"SPLATLINE_{register.name}_{field.name}"
            lines += [
                f"/* {field.access.value}: {field.meaning} */",
                f"#define {name}_SHIFT {field.place.lsb}u",
                f"#define {name}_MASK {field.mask:#010x}u",
            ]
            if field.access.readable and not field.live:
                lines.append(f"#define {name}_RESET {field.reset}u")
    window = registers.materials
    lines += [
        "",
        "/* The material table: entry n at OFFSET + n * STRIDE, its words the lowest first, of",
        " * which the last writes it. A field's bits are counted from bit 0 of the first word. */",
        f"#define SPLATLINE_MATERIAL_OFFSET {window.offset:#06x}u",
        f"#define SPLATLINE_MATERIAL_ENTRIES {window.entries}u",
        f"#define SPLATLINE_MATERIAL_STRIDE {window.stride}u",
        f"#define SPLATLINE_MATERIAL_WORDS {window.words}u",
    ]
    for field in window.fields:
        lines += [
            f"#define SPLATLINE_MATERIAL_{field.name}_BIT {field.place.lsb}u",
            f"#define SPLATLINE_MATERIAL_{field.name}_WIDTH {field.place.width}u",
        ]
    return "\n".join([*lines, "", "#endif", ""])


def json_map(registers: RegisterMap) -> dict:
    """Return the map as plain lists and dictionaries."""
    window = registers.materials
    return {
        "preset": registers.config.name,
        "bytes": 1 << registers.address_bits,
        "registers": [
            {
                "name": register.name,
                "offset": register.offset,
                "meaning": register.meaning,
                "between_frames": register.between_frames,
                "fields": _json_fields(register.fields),
            }
            for register in registers.registers
        ],
        "materials": {
            "offset": window.offset,
            "entries": window.entries,
            "stride": window.stride,
            "words": window.words,
            "fields": _json_fields(window.fields),
        },
        "streams": {"codeword_bytes": 8, "raster_bytes": raster_stream_bytes(registers.config)},
    }


def _json_fields(fields: Iterable[BusField]) -> list[dict]:
    return [
        {
            "name": field.name,
            "lsb": field.place.lsb,
            "width": field.place.width,
            "access": field.access.value,
            "meaning": field.meaning,
            **({} if field.live or not field.access.readable else {"reset": field.reset}),
        }
        for field in fields
    ]


def markdown(registers: RegisterMap) -> str:
    """Return the map as a page."""
    config, window = registers.config, registers.materials
    lines = [
        "# Registers and streams of the engine on AXI",
        "",
        f"Preset `{config.name}`. Made by `splatline registers --preset {config.name} --markdown"
        " FILE`, from [`contract/register_map.py`](../rtl/register_map.py).",
        "",
        *PROSE.format(beat=config.raster_end.end, size=raster_stream_bytes(config)).split("\n")[1:],
        "## Registers",
        "32 bits each, at byte offsets. Access: "
        + "; ".join(f"`{access.value}`, {meaning}" for access, meaning in ACCESSES.items())
        + ". Bits without a field read 0, and a write that sets one is refused. **Between frames**:"
        " a write while STATUS.BUSY is refused.",
        "",
        "| offset | register | bits | field | access | reset | meaning |",
        "|---:|---|---:|---|---|---:|---|",
        *_rows(registers),
        "",
        "## Materials",
        f"{window.entries} entries from `{window.offset:#06x}`, {window.stride} bytes apart, each"
        f" of {window.words} words, the lowest first. The low words wait in one place, which all"
        " entries share, until the last word of an entry writes it. Write only, between frames.",
        "",
        "| bits of an entry | field |",
        "|---:|---|",
        *(
            f"| {field.place.end - 1}..{field.place.lsb} | {field.meaning} |"
            for field in window.fields
        ),
    ]
    return "\n".join([*lines, ""])


def _rows(registers: RegisterMap) -> Iterator[str]:
    """Yield a table row for each field, the first of a register with its name."""
    for register in registers.registers:
        note = "; between frames" if register.between_frames else ""
        head = f"| `{register.offset:#04x}` | **{register.name}**: {register.meaning}{note} "
        for field in register.fields:
            place = field.place
            bits = f"{place.lsb}" if place.width == 1 else f"{place.end - 1}..{place.lsb}"
            known = field.access.readable and not field.live
            reset = field.reset if field.reset < 1 << 16 else f"{field.reset:#x}"
            cells = (
                bits,
                field.name,
                field.access.value,
                f"{reset if known else ''}",
                field.meaning,
            )
            yield f"{head}| {' | '.join(cells)} |"
            head = "| | "
