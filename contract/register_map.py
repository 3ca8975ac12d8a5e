"""The registers of the engine's AXI4-Lite port, in plain Python.

The register file (:mod:`splatline.rtl.bus.axi_registers`), the C header, the JSON map, the page
``docs/registers.md`` and the driver are all made from it. This file imports no Amaranth.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from .beat_layout import raster_stream_bytes
from .config import SHAPES, WINDOWS, EngineConfig
from .fields import Field, Register
from .register_types import Access, BusField, BusRegister, MaterialWindow, RegisterMap

__all__ = ["CHOICES", "COUNTERS", "IDENTITY", "VERSION", "register_map", "version_of"]

WORD = 4
"""Bytes of a register."""

MATERIALS = 0x2000
"""Offset of the material table in every configuration; the largest table ends at twice that."""

IDENTITY = 0x53504C54
"""``SPLT``: the value of the first register."""

VERSION = (2, 0)
"""Version of the map: the first number grows if an old driver would no longer work."""

PLANE_VERSION = (3, 0)
"""Version for engines with planes: a driver of version 2 would send them words of 64 bits."""

PARAMETERS = (
    {
        "x_bits": 4, "line_bits": 4, "depth_bits": 5, "channel_bits": 4, "intensity_bits": 4,
        "material_bits": 4, "coefficient_bits": 4, "window": 1,
    },
    {
        "colour_shift": 5, "window_lines": 6, "pixels_per_word": 4, "shapes": 2,
        "raster_words": 2, "beat_bytes": 8, "plane": 1, "slope_bits": 4,
    },
)  # fmt: skip
"""Bits of each parameter of the configuration in CONFIG_0 and in CONFIG_1, and of ``beat_bytes``.

A new one goes above the others, into bits that were 0 before.
"""

STATUS = {
    "BUSY": "a frame is open: writes to tables and size are refused",
    "DROPPING": "the rest of a packet of code words is being dropped, up to its tlast",
    "DROPPING_INITIAL": "the rest of an initial raster is being dropped, up to its tlast",
    "ABORTING": "an aborted frame is on its way out",
}

ERRORS = {
    "X_OUTSIDE": "an element beyond the last column, of which nothing is drawn",
    "LINE_PAST": "a step to where no element touches the image any more",
    "FRAME_ENDED_EARLY": "tlast before the end word, which was put in",
    "END_WITHOUT_LAST": "an end word without tlast; what followed was dropped",
    "PARTIAL_WORD": "a code word without some of its bytes, which was dropped",
    "INITIAL_ENDED_EARLY": "tlast before the initial raster's end beat, which was put in",
    "INITIAL_WITHOUT_LAST": "its end beat without tlast; what followed was dropped",
    "INITIAL_PARTIAL": "a beat of it without some of its bytes, which was dropped",
    "ABORTED": "a frame was aborted: its picture is not whole",
    "BUS_ADDRESS": "an access to where nothing is (DECERR)",
    "BUS_ACCESS": "a write of what is read only, or a read of what is write only (SLVERR)",
    "BUS_STROBE": "a write of less than 32 bits (SLVERR)",
    "BUS_VALUE": "a write with a 1 in a bit that the register does not accept (SLVERR)",
    "BUS_BUSY": "a write to tables or size while a frame was open (SLVERR)",
}

INTERRUPTS = {"FRAME_DONE": "an end beat has left", "ERROR": "a bit of ERROR is set"}

COUNTERS = {
    "FRAMES": "frames done: end beats that left",
    "ELEMENTS": "code words that the engine took, control words left out",
    "CYCLES": "cycles in which a frame was open, from its first code word to its end beat",
    "INPUT_STALLS": "cycles in which a code word waited for the engine",
    "OUTPUT_STALLS": "cycles in which a beat waited to be taken",
    "WORDS": "words of the raster that were sent",
}
"""Each wraps at 2^32."""


def version_of(config: EngineConfig) -> tuple[int, int]:
    """Return the version of an engine's map."""
    return PLANE_VERSION if config.plane else VERSION


def register_map(config: EngineConfig) -> RegisterMap:
    """Return the register map of an engine."""
    registers = (*_identity(config), *_control(), *_frame(config), *_counters())
    return RegisterMap(
        config,
        tuple(
            BusRegister(
                name,
                number * WORD,
                meaning,
                tuple(_stack(fields)),
                between_frames=table is not None,
                table=None if table is None else config.register_base + table,
            )
            for number, (name, meaning, fields, table) in enumerate(registers)
        ),
        _materials(config),
    )


CHOICES: dict[str, tuple[str | int, ...]] = {"shapes": tuple(SHAPES), "window": tuple(WINDOWS)}
"""Parameters whose field is the number of a choice."""

MEANINGS = {
    "beat_bytes": "bytes of a beat of both rasters",
    "plane": "`plane`; 1: code words of 96 bits, 16 bytes on the stream; 0: of 64 bits",
    "slope_bits": "`slope_bits`; 0 without planes",
}
"""Meanings of fields of CONFIG that have more to say than a parameter's name."""

# A register in short: its name, meaning and fields, and the engine's register that it becomes.
_Row = tuple[str, str, list[BusField], int | None]


def _identity(config: EngineConfig) -> Iterator[_Row]:
    """Yield the registers that a driver checks first."""
    yield "ID", "what this is", [_constant("VALUE", 32, IDENTITY, "`SPLT`")], None
    major, minor = version_of(config)
    version = [
        _constant("MINOR", 8, minor, "additions that an old driver need not know"),
        _constant("MAJOR", 8, major, "grows where an old driver would not work; 3: with planes"),
    ]
    yield "VERSION", "of this map", version, None
    for number, widths in enumerate(PARAMETERS):
        fields = [
            _constant(name.upper(), width, _number(config, name), _meaning(name))
            for name, width in widths.items()
        ]
        yield f"CONFIG_{number}", "the engine's parameters, see `EngineConfig`", fields, None


def _number(config: EngineConfig, name: str) -> int:
    """Return a parameter as a number; a choice is its number among ``CHOICES``."""
    if name == "beat_bytes":
        return raster_stream_bytes(config)
    if name == "slope_bits" and not config.plane:
        return 0
    value = getattr(config, name)
    return CHOICES[name].index(value) if name in CHOICES else int(value)


def _meaning(name: str) -> str:
    """Return the meaning of a parameter's field, with the numbers of its choices."""
    if name in MEANINGS:
        return MEANINGS[name]
    choices = (f"{number}: {choice}" for number, choice in enumerate(CHOICES.get(name, ())))
    return "; ".join([f"`{name}`", *choices])


def _control() -> Iterator[_Row]:
    """Yield the registers of control, status and interrupts."""
    control = [
        _field("HOLD", 1, Access.READ_WRITE, "no further frame begins: its code words wait"),
        _field("QUIET", 1, Access.READ_WRITE, "the bus answers OKAY where it would be an error"),
        _field("ABORT", 1, Access.WRITE_ONLY, "ends the frame that is open"),
        _field("RESYNC", 1, Access.WRITE_ONLY, "drops no more: what comes next is a new packet"),
        _field("CLEAR", 1, Access.WRITE_ONLY, "clears the counters"),
    ]
    yield "CONTROL", "of the streams and of this bus", control, None
    yield "STATUS", "what goes on", [_live(name, STATUS[name]) for name in STATUS], None
    errors = [_field(name, 1, Access.CLEAR, meaning) for name, meaning in ERRORS.items()]
    yield "ERROR", "what bad input was seen since the bits were cleared", errors, None
    causes = [
        _field("FRAME_DONE", 1, Access.CLEAR, INTERRUPTS["FRAME_DONE"]),
        _live("ERROR", INTERRUPTS["ERROR"]),
    ]
    yield "IRQ_STATUS", "causes of an interrupt", causes, None
    enable = [_field(name, 1, Access.READ_WRITE, f"{name} raises `irq`") for name in INTERRUPTS]
    yield "IRQ_ENABLE", "which of them raise `irq`", enable, None


def _frame(config: EngineConfig) -> Iterator[_Row]:
    """Yield the engine's own registers, which hold for a whole frame."""
    for name, bits, size, table in zip(
        ("column", "line"),
        (config.x_bits, config.line_bits),
        config.reset_size,
        (Register.LAST_COLUMN, Register.LAST_LINE),
        strict=True,
    ):
        last = _field("VALUE", bits, Access.READ_WRITE, f"{name}s less 1", size - 1)
        yield f"LAST_{name.upper()}", f"last {name} of the image", [last], table
    load = _field("LOAD", 1, Access.READ_WRITE, "frames start from the raster on `s_axis_initial`")
    yield "START", "what a frame starts from", [load], Register.CONTROL
    for table, channel in enumerate(("RED", "GREEN", "BLUE"), Register.AMBIENT_RED):
        meaning = f"with {config.colour_shift} fraction bits"
        value = _field("VALUE", config.ambient_bits, Access.WRITE_ONLY, meaning)
        yield f"AMBIENT_{channel}", f"I0 of {channel.lower()}", [value], table


def _counters() -> Iterator[_Row]:
    for name, meaning in COUNTERS.items():
        yield name, meaning, [_live("VALUE", "wraps at 2^32", 32)], None


def _materials(config: EngineConfig) -> MaterialWindow:
    """Return the material table's window."""
    words = -(-6 * config.coefficient_bits // 32)
    fields = tuple(
        BusField(
            f"{name}_{colour}",
            config.coefficient(kind, channel),
            Access.WRITE_ONLY,
            f"{name.lower()} of {colour.lower()}",
        )
        for kind, name in enumerate(("KD", "KS"))
        for channel, colour in enumerate(("RED", "GREEN", "BLUE"))
    )
    stride = WORD << (words - 1).bit_length()
    return MaterialWindow(MATERIALS, config.register_base, words, stride, fields)


def _field(name: str, width: int, access: Access, meaning: str, reset: int = 0) -> BusField:
    """Return a field whose position ``_stack`` will set."""
    return BusField(name, Field(0, width), access, meaning, reset)


def _constant(name: str, width: int, value: int, meaning: str) -> BusField:
    if not 0 <= value < 1 << width:
        raise ValueError(f"{name}: {value} does not fit {width} bits")
    return _field(name, width, Access.READ_ONLY, meaning, value)


def _live(name: str, meaning: str, width: int = 1) -> BusField:
    return BusField(name, Field(0, width), Access.READ_ONLY, meaning, live=True)


def _stack(fields: list[BusField]) -> Iterator[BusField]:
    """Yield fields each above the one before."""
    lsb = 0
    for field in fields:
        yield dataclasses.replace(field, place=Field(lsb, field.place.width))
        lsb += field.place.width
