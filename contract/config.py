"""The engine's configuration and every bit position of its contract, in plain Python.

The hardware, the host and the golden renderer take all widths and positions from here. This file
imports no Amaranth, so it loads fast. ``docs/contract.md`` describes the fields.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from .fields import Field
from .plane import LOW_BITS, PLANE_BITS, SIDES, Z_FRACTION, PlaneFields

__all__ = [
    "BLOCK",
    "COMPACT",
    "MEMORIES",
    "MOST_BEAT_BITS",
    "ROWS",
    "SHAPES",
    "WINDOWS",
    "EngineConfig",
]

BLOCK = 8
"""Rows and columns of the block of pixels that one code word can cover."""

ROWS = 4
"""Rows of a block in a code word; symmetry gives the others."""

COMPACT = 0b00010
"""The mark of a compact word."""

WINDOWS: dict[str, dict[str, tuple[int, ...]]] = {
    "tiles": {"window_lines": (8, 16, 32), "pixels_per_word": (2, 4, 8), "raster_words": (1,)},
    "blocks": {"window_lines": (16, 32), "pixels_per_word": (8,), "raster_words": (2,)},
}
"""The kinds of window, and the values that each allows."""

SHAPES = {"none": -1, "small": BLOCK, "full": 2 * BLOCK}
"""The shape ROMs, and the largest size that each holds."""

MEMORIES = ("dual", "simple")
"""The kinds of block RAM that the hardware may use."""

MOST_BEAT_BITS = 1024
"""Most bits of a raster beat: 128 bytes is the widest stream of common DMA cores."""


def _is_among(value: object, choices: tuple[int, ...]) -> bool:
    """Return whether a parameter is an integer among the choices."""
    return isinstance(value, int) and value in choices


@dataclass(frozen=True, kw_only=True)
class EngineConfig(PlaneFields):
    """The parameters of an engine, which are fixed when its Verilog is written.

    Parameters
    ----------
    name
        Name of the preset.
    x_bits
        Bits of a code word's X, the image column of the block's first column; an image has at most
        ``2**x_bits`` columns.
    line_bits
        Bits of a line number; an image has at most ``2**line_bits`` lines.
    depth_bits
        Bits of a stored depth and of a code word's Z. The largest value is the background.
    channel_bits
        Bits of each of the three channels of a stored colour.
    intensity_bits
        Bits of a code word's DIFFUSE and SPECULAR.
    material_bits
        Bits of a code word's MATERIAL; the table has ``2**material_bits`` entries.
    coefficient_bits
        Bits of each of a material's six coefficients: kd and ks for red, green and blue.
    colour_shift
        Fraction bits of the colour sum, dropped after the addition.
    window
        How the window draws. ``tiles``: a tile of four lines and a memory word's columns a cycle,
        in four lanes for each column; small. ``blocks``: a whole element a cycle, in eight rows of
        lanes; fast.
    window_lines
        Lines of the sliding window: 8, 16 or 32 with tiles, 16 or 32 with blocks. Eight are drawn
        into; the others wait to be flushed.
    pixels_per_word
        Pixels in one raster word: 2, 4 or 8 with tiles, 8 with blocks. Each lies in a lane of its
        own, so a memory word is one pixel.
    raster_words
        Raster words in a beat: 1 with tiles, 2 with blocks, whose neighbours leave together.
    shapes
        One of ``SHAPES``: the ROM that expands compact words. ``none``: no ROM, and no compact
        words.
    plane
        Whether a code word carries the plane of its element, in 96 bits: every pixel has a depth of
        its own. Such an engine has no shape ROM.
    slope_bits
        Bits of each of a plane's two slopes, in 3..8; counts with ``plane`` alone.
    memory
        What the block RAMs can do. ``dual``: both ports write (true dual port). ``simple``: one
        port writes and the other reads, which every family of FPGAs infers. It is no part of the
        contract: pictures, code words and registers are the same. ``simple`` takes more cycles
        with an initial raster, and with ``pixels_per_word`` 8. With ``tiles`` alone.

    Raises
    ------
    ValueError
        If a value is out of its range, if the code word does not have 64 bits, if the fields of a
        plane word do not fit their halves, or if a beat of the raster has more than 1024 bits.
    """

    name: str = "custom"
    x_bits: int = 9
    line_bits: int = 10
    depth_bits: int = 9
    channel_bits: int = 3
    intensity_bits: int = 7
    material_bits: int = 7
    coefficient_bits: int = 6
    colour_shift: int = 10
    window: str = "tiles"
    window_lines: int = 16
    pixels_per_word: int = 4
    raster_words: int = 1
    shapes: str = "none"
    plane: bool = False
    slope_bits: int = 7
    memory: str = "dual"

    def __post_init__(self) -> None:
        """Check every parameter, so that components need not."""
        ranges = {
            "x_bits": (4, 12),
            "line_bits": (5, 14),
            "depth_bits": (1, 16),
            "channel_bits": (1, 8),
            "intensity_bits": (1, 9),
            "material_bits": (3, 9),  # the registers need as many addresses as six
            "coefficient_bits": (1, 12),
            "colour_shift": (1, self.coefficient_bits + self.intensity_bits),
            "slope_bits": (3, 8),
        }
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not isinstance(value, int) or not low <= value <= high:
                raise ValueError(f"{name} must be an integer in {low}..{high}, not {value!r}")
        # Integers alone, although 8.0 is in (4, 8).
        if self.window not in WINDOWS:
            raise ValueError(f"window must be {' or '.join(WINDOWS)}, not {self.window!r}")
        for name, choices in WINDOWS[self.window].items():
            value = getattr(self, name)
            if not _is_among(value, choices):
                *most, last = map(str, choices)
                allowed = f"{', '.join(most)} or {last}" if most else last
                raise ValueError(f"{name} must be {allowed} with {self.window}, not {value!r}")
        if self.word_bits < 2:
            raise ValueError(
                f"x_bits must be at least {self.pixel_bits + 2}"
                f" for {self.pixels_per_word} pixels a word, not {self.x_bits}"
            )
        if self.memory not in MEMORIES:
            raise ValueError(f"memory must be {' or '.join(MEMORIES)}, not {self.memory!r}")
        if self.memory == "simple" and self.window != "tiles":
            raise ValueError("memory must be dual with blocks, not 'simple'")
        if self.shapes not in SHAPES:
            raise ValueError(f"shapes must be {', '.join(SHAPES)}, not {self.shapes!r}")
        self._check_codeword()
        if self.raster_end.end > MOST_BEAT_BITS:
            raise ValueError(
                f"a beat of the raster must have at most {MOST_BEAT_BITS} bits,"
                f" not {self.raster_end.end}"
            )

    def _check_codeword(self) -> None:
        """Raise ``ValueError`` unless the fields of a code word fit it."""
        if not isinstance(self.plane, bool):
            raise ValueError(f"plane must be True or False, not {self.plane!r}")
        if not self.plane:
            if self.z.end != 64:
                raise ValueError(f"the code word must have 64 bits, not {self.z.end}")
            return
        if self.shapes != "none":
            raise ValueError("an engine with planes has no shape ROM")
        if self.x.end > LOW_BITS - SIDES:
            raise ValueError(
                f"MODE to X of a plane word must have at most {LOW_BITS - SIDES} bits,"
                f" not {self.x.end}"
            )
        if self.z.end > PLANE_BITS:
            raise ValueError(f"a plane word must have at most {PLANE_BITS} bits, not {self.z.end}")

    def replace(self, **changes: object) -> EngineConfig:
        """Return a copy with some parameters changed; the name becomes ``custom`` unless given."""
        return dataclasses.replace(self, **{"name": "custom", **changes})  # type: ignore[arg-type]

    def with_shapes(self, shapes: str = "small") -> EngineConfig:
        """Return the engine with a shape ROM, named as ``paper-rom``; itself if it has one."""
        if self.shapes != "none":
            return self
        suffix = "-rom" if shapes == "small" else f"-rom-{shapes}"
        return self.replace(name=self.name + suffix, shapes=shapes)

    def with_memory(self, memory: str) -> EngineConfig:
        """Return the engine with other block RAMs, named as ``rgb24-simple``, or itself.

        Raises
        ------
        ValueError
            If its window needs true dual-port memories.
        """
        if memory == self.memory:
            return self
        base = self.name.removesuffix("-simple")
        return self.replace(name=base if memory == "dual" else f"{base}-{memory}", memory=memory)

    # The code word, bit 0 first.

    @property
    def mode(self) -> Field:
        """0: the rows 0..3 and their half rotation; 1: the rows 0..3 alone (a fraction)."""
        return Field(0, 1)

    @property
    def scans(self) -> Field:
        """Four rows of six bits."""
        return Field(1, 6 * ROWS)

    def first(self, row: int) -> Field:
        """First column of a row, inclusive."""
        return Field(self.scans.lsb + 6 * row, 3)

    def last(self, row: int) -> Field:
        """Last column of a row, inclusive; ``first > last``: it is empty, or marks a half pixel."""
        return Field(self.scans.lsb + 6 * row + 3, 3)

    @property
    def diffuse(self) -> Field:
        """Diffuse intensity D."""
        return Field(self.scans.end, self.intensity_bits)

    @property
    def specular(self) -> Field:
        """Specular intensity S."""
        return Field(self.diffuse.end, self.intensity_bits)

    @property
    def material(self) -> Field:
        """Index into the material table."""
        return Field(self.specular.end, self.material_bits)

    @property
    def x(self) -> Field:
        """Image column of the block's column 0; of a control word: lines to advance."""
        return Field(self.material.end, self.x_bits)

    @property
    def z(self) -> Field:
        """Depth, smaller is nearer; of a plane word with ``Z_FRACTION`` fraction bits."""
        if self.plane:
            return Field(self.scale.end, self.depth_bits + Z_FRACTION)
        return Field(self.x.end, self.depth_bits)

    @property
    def codeword_bits(self) -> int:
        """Bits of a code word: 64, or 96 with planes."""
        return PLANE_BITS if self.plane else LOW_BITS

    @property
    def control_end(self) -> Field:
        """End of frame; counts in control words alone."""
        return Field(self.diffuse.lsb, 1)

    # A compact word has MODE 0, and ``COMPACT`` instead of row 3's upper bits. So the ends of row 3
    # are 4 or 5 and 0, as in no raised shape.

    @property
    def compact_mark(self) -> Field:
        """``COMPACT`` in a compact word: row 3 without its lowest bit."""
        return Field(self.first(ROWS - 1).lsb + 1, 5)

    @property
    def compact_size(self) -> Field:
        """Diameter of the shape."""
        return Field(self.scans.lsb, 5)

    @property
    def compact_level_x(self) -> Field:
        """Level of n'x."""
        return Field(self.compact_size.end, 6)

    @property
    def compact_level_y(self) -> Field:
        """Level of n'y."""
        return Field(self.compact_level_x.end, 6)

    @property
    def compact_part(self) -> Field:
        """Number of the four lines in a shape of sixteen; sizes up to 8 have one part."""
        return Field(self.compact_level_y.end, 2)

    @property
    def largest_shape(self) -> int:
        """Largest size that the shape ROM holds; -1 if there is none."""
        return SHAPES[self.shapes]

    # The image.

    @property
    def max_width(self) -> int:
        """Most columns of an image."""
        return 1 << self.x_bits

    @property
    def max_height(self) -> int:
        """Most lines of an image."""
        return 1 << self.line_bits

    @property
    def reset_size(self) -> tuple[int, int]:
        """Columns and lines of the image after a reset: 512, or as many as there can be."""
        return min(512, self.max_width), min(512, self.max_height)

    @property
    def background_depth(self) -> int:
        """Depth of a pixel that nothing was drawn into."""
        return (1 << self.depth_bits) - 1

    @property
    def colour_bits(self) -> int:
        """Bits of a stored colour: red lowest, then green, then blue."""
        return 3 * self.channel_bits

    @property
    def channel_max(self) -> int:
        """Largest value of a stored channel, at which the colour sum saturates."""
        return (1 << self.channel_bits) - 1

    # The tables: a write is (address, data).

    @property
    def register_base(self) -> int:
        """Address of the first register; below it, each address is a material."""
        return 1 << self.material_bits

    @property
    def table_address(self) -> Field:
        """Address bits of a table write."""
        return Field(self.table_data.end, self.material_bits + 1)

    @property
    def table_data(self) -> Field:
        """Data bits of a table write: wide enough for a material and for every register."""
        return Field(
            0, max(6 * self.coefficient_bits, self.ambient_bits, self.line_bits, self.x_bits)
        )

    def coefficient(self, kind: int, channel: int) -> Field:
        """Bits of a material's kd (``kind`` 0) or ks (``kind`` 1) of a channel in 0..2."""
        return Field((3 * kind + channel) * self.coefficient_bits, self.coefficient_bits)

    @property
    def ambient_bits(self) -> int:
        """Bits of I0, which has ``colour_shift`` fraction bits: as many as ``kd D + ks S`` has."""
        return self.coefficient_bits + self.intensity_bits + 1

    # The raster: a beat is a raster word with its line and number, or the end of the frame.

    @property
    def pixel_bits(self) -> int:
        """Bits of the number of a pixel in its word."""
        return self.pixels_per_word.bit_length() - 1

    @property
    def word_bits(self) -> int:
        """Bits of the number of a window word in its line."""
        return self.x_bits - self.pixel_bits

    @property
    def block_words(self) -> int:
        """Most window words of a line that an element can touch.

        An element has nine columns, as its rotated rows may lie one column further right.
        """
        return (BLOCK + self.pixels_per_word - 1) // self.pixels_per_word + 1

    @property
    def raster_pixels(self) -> int:
        """Pixels in a beat of the raster."""
        return self.pixels_per_word * self.raster_words

    @property
    def slot_bits(self) -> int:
        """Bits of a slot, which is a line's number modulo the window's lines."""
        return self.window_lines.bit_length() - 1

    @property
    def draws_blocks(self) -> bool:
        """Whether the window draws a whole element a cycle, in eight rows of lanes."""
        return self.window == "blocks"

    @property
    def tile_lines(self) -> int:
        """Lines that the window draws in a cycle, each in its own row of lanes: 4 or 8."""
        return BLOCK if self.draws_blocks else 4

    @property
    def group_bits(self) -> int:
        """Bits of a group: a slot without its lowest bits, which name the row of lanes."""
        return self.slot_bits - (self.tile_lines.bit_length() - 1)

    @property
    def flush_words(self) -> int:
        """Window words that leave lanes at one request: 1, or a pair with words of eight pixels.

        The second word leaves a cycle later, through the port that otherwise writes, which must
        read as well.
        """
        pairs = self.window == "tiles" and self.pixels_per_word == BLOCK
        return 2 if pairs and self.memory == "dual" else 1

    @property
    def clear_cycles(self) -> int:
        """Cycles after a reset in which the window is cleared: the pixels of one of its memories.

        A memory of rows of lanes has the even words of its lines, or the odd ones.
        """
        return 1 << self.group_bits + self.word_bits - self.draws_blocks

    def raster_depth(self, pixel: int) -> Field:
        """Depth of a pixel of the beat; pixel 0 is the leftmost."""
        return Field(pixel * self.depth_bits, self.depth_bits)

    def raster_colour(self, pixel: int) -> Field:
        """Colour of a pixel of the beat."""
        base = self.raster_pixels * self.depth_bits
        return Field(base + pixel * self.colour_bits, self.colour_bits)

    @property
    def raster_word(self) -> Field:
        """Number of the beat's word in its line: columns ``raster_pixels * word`` and up."""
        width = self.word_bits - (self.raster_words - 1)
        return Field(self.raster_colour(self.raster_pixels - 1).end, width)

    @property
    def raster_line(self) -> Field:
        """Line of the image."""
        return Field(self.raster_word.end, self.line_bits)

    @property
    def raster_end(self) -> Field:
        """1: the frame ends, and the beat's other fields mean nothing."""
        return Field(self.raster_line.end, 1)
