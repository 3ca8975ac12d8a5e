"""The register map as a C header, as JSON and as a page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from splatline.contract.beat_layout import beat_fields, raster_stream_bytes
from splatline.contract.codeword_layout import codeword_fields, codeword_stream_bytes
from splatline.contract.register_types import Access, BusField, RegisterMap

from .stream_texts import field_rows, json_beat, json_codeword, stream_macros

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
| `s_axis_codewords` | {word_size} | the code words of a frame; TLAST with the end word |
| `s_axis_initial` | {size} | the raster that a frame starts from; TLAST with the end beat |
| `m_axis_raster` | {size} | the picture's beats; TLAST with the end beat |

Every packet of code words is answered by one of the raster, which has at least the end beat.

Bit 0 of a code word or beat is bit 0 of TDATA, in the first byte in memory
([`contract.md`](contract.md)). A code word:

| bits | field | meaning |
|---|---|---|
{word_fields}

A raster beat has {pixels} neighbouring pixels of a line:

| bits | field | meaning |
|---|---|---|
{fields}

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
come, because the host's DMA was reset, write RESYNC after it. An initial raster of which no beat
has come by then is not dropped: it waits for the next frame that asks for one.

## Answers of the bus

A refused access changes nothing and sets a bit of ERROR. The answer is DECERR where no register is
and SLVERR elsewhere. A refused read gives 0. A write must have all four bytes: one whose WSTRB is
not all ones is refused. The two lowest bits of an address are ignored. With CONTROL.QUIET every
answer is OKAY, because on many processors a bus error ends the program. ERROR is set all the same.

One refused write can set two bits of ERROR, for instance BUS_STROBE and BUS_VALUE. A driver may
always write back to a register what it read from it, if the register can be written at all:

| kind of register | a 1 in a read-only bit, or in a bit without a field |
|---|---|
| with `w1c` fields: ERROR, IRQ_STATUS | is ignored; the fields with a 1 are cleared |
| with `rw` or `wo` fields: CONTROL, the size and others | the write is refused: BUS_VALUE |
| with `ro` fields only | every write is refused: BUS_ACCESS |

To acknowledge an interrupt, read IRQ_STATUS and write the value back. IRQ_STATUS.ERROR is 1 as long
as a bit of ERROR is: clear those too.

## Special cases

- A packet of nothing but partial words is an empty frame. It sets PARTIAL_WORD and
  FRAME_ENDED_EARLY.
- The low word of a material is refused while BUSY, as the last word is.
- LINE_PAST is set by a step to line height + 4 or beyond. An element about line height + 3 still
  reaches the last line of the image.
- A beat of background alone does not leave, whether it was drawn or came with the initial raster.

## Reset

`aresetn` is active low and synchronous. One clock edge is enough. A reset sets every register to
the value below, and I0 to 0. The materials keep their values. Then the engine clears its window
({clear} cycles). Table writes are taken meanwhile, and code words wait. CYCLES and INPUT_STALLS of
the first frame count this time.
"""


def c_header(registers: RegisterMap) -> str:
    """Return the map as a header for C99 that needs only ``stdint.h``.

    For each register ``SPLATLINE_NAME_OFFSET``, in bytes; for each field ``_MASK``, ``_SHIFT`` and
    ``_RESET``. ``SPLATLINE_GET`` and ``SPLATLINE_PUT`` take a field out of a word and put it in.
    For each field of a code word ``SPLATLINE_CODEWORD_NAME_LSB`` and ``_WIDTH``, which
    ``SPLATLINE_CODEWORD_GET`` and ``SPLATLINE_CODEWORD_PUT`` unpack and pack; of a raster beat the
    same with ``BEAT``.
    """
    lines = [
        f"/* Registers of a Splatline engine, preset {registers.config.name}.",
        f" * Made by: splatline registers --preset {registers.config.name} --c-header FILE */",
        "#ifndef SPLATLINE_REGISTERS_H",
        "#define SPLATLINE_REGISTERS_H",
        "",
        "#include <stdint.h>",
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
    return "\n".join([*lines, *stream_macros(registers.config), "#endif", ""])


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
        "streams": {
            "codeword_bytes": codeword_stream_bytes(registers.config),
            "raster_bytes": raster_stream_bytes(registers.config),
        },
        "codeword": json_codeword(registers.config),
        "beat": json_beat(registers.config),
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
        " FILE`, from [`contract/register_map.py`](../contract/register_map.py).",
        "",
        *PROSE.format(
            size=raster_stream_bytes(config),
            pixels=config.raster_pixels,
            word_size=codeword_stream_bytes(config),
            word_fields="\n".join(field_rows(codeword_fields(config))),
            fields="\n".join(field_rows(beat_fields(config))),
            clear=config.clear_cycles,
        ).split("\n")[1:],
        "## Registers",
        "32 bits each, at byte offsets. Access: "
        + "; ".join(f"`{access.value}`, {meaning}" for access, meaning in ACCESSES.items())
        + ". Bits without a field read 0."
        " **Between frames**: a write while STATUS.BUSY is refused.",
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
