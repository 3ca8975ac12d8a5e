"""The tables and figures of the contract's page are those of ``contract/``."""

import re
from pathlib import Path

import pytest

from splatline.contract.beat_layout import beat_fields, raster_stream_bytes
from splatline.contract.codeword_layout import (
    codeword_fields,
    codeword_stream_bytes,
    compact_fields,
)
from splatline.contract.config import COMPACT, SHAPES
from splatline.contract.fields import Register
from splatline.contract.plane import SHIFTS
from splatline.contract.presets import PAPER, PLANE, PRESETS, RGB24
from splatline.contract.variants import PLANE_VARIANTS, SHAPED

PAGE = (Path(__file__).parents[2] / "docs/contract.md").read_text(encoding="utf-8")
HEADING = r"^#{2,3} "


def section(heading):
    """Return a section of the page, up to the next heading."""
    (text,) = re.findall(rf"{HEADING}{heading}\n(.*?)(?={HEADING}|\Z)", PAGE, re.M | re.S)
    return text


def table(heading):
    """Return the rows of a section's table, each a list of cells, with its head."""
    rows = re.findall(r"^\| (.*) \|$", section(heading), re.M)
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)] for row in rows]


def bits(field):
    """Return the bits of a field, as the page writes them."""
    return f"{field.lsb}..{field.end - 1}" if field.end - field.lsb > 1 else str(field.lsb)


def told(heading):
    """Return the bits of a table of fields, by name in small letters; a row may have two fields."""
    fields = {}
    for names, places, _ in table(heading)[1:]:
        each = names.lower().split(", ")
        fields |= zip(each, places.split(", ") if len(each) > 1 else [places], strict=True)
    return fields


def test_code_words():
    assert told("Code words") == {f.name: bits(f) for f in codeword_fields(PAPER)}


def test_compact_words():
    fields = {f.name: f for f in compact_fields(SHAPED[0])}
    assert told("Compact words") == {
        "size": bits(fields["size"]),
        "level of n'x": bits(fields["level_x"]),
        "level of n'y": bits(fields["level_y"]),
        "part": bits(fields["part"]),
    }
    text = section("Compact words")
    mark = fields["mark"]
    assert f"bits {bits(mark)} are {COMPACT:05b} (bit 21 is 1, the others 0)" in text
    assert 1 << 21 - mark.lsb == COMPACT
    assert f"From bit {fields['diffuse'].lsb} on" in text
    assert f"diameter in pixels, 0..{SHAPES['full']}" in text
    assert f"(over {SHAPES['small']}, `small`; over {SHAPES['full']}, `full`)" in text


def test_plane_words():
    outwards = ", ".join(str(PLANE.outwards(end).lsb) for end in range(2))
    sides = PLANE.side(0, 0).lsb
    expected = {f.name: bits(f) for f in codeword_fields(PLANE) if f.name != "padding"}
    assert told("Plane words") == expected | {"outwards": outwards}
    text = section("Plane words")
    assert f"the bit {sides} + 2k for its first column rotated, and {sides + 1} + 2k" in text
    assert f"shifted left by {', '.join(map(str, SHIFTS[:-1]))} or {SHIFTS[-1]} bits" in text
    assert f"code words of {PLANE.codeword_bits} bits" in text
    assert f"/ 4), 0), {PLANE.background_depth})" in text
    z, slope, largest = 2 * PLANE.z.mask, 1 << PLANE.slope_bits - 1, 1 << SHIFTS[-1]
    low, high = -largest * slope, largest * (slope - 1)
    assert f"2 Z is at most {z}, a and b are in {low} .. {high}," in text
    assert f"it lies in {14 * low} .. {z + 14 * high} and fits 16 bits, signed" in text
    assert -(1 << 15) <= 14 * low < z + 14 * high < 1 << 15
    (large,) = PLANE_VARIANTS
    d, s, m, x = (bits(getattr(large, n)) for n in ("diffuse", "specular", "material", "x"))
    assert (
        f"images of up to {large.max_width} x {large.max_height} pixels: D and S have"
        f" {large.intensity_bits} bits ({d}, {s}), M has {large.material_bits} ({m}), X has"
        f" {large.x_bits} ({x}), `colour_shift` is {large.colour_shift}."
    ) in text


def test_raster():
    head, *rows = table("Raster")
    assert head == ["field", *(f"`{name}`" for name in PRESETS)]
    columns = {name: [row[n] for row in rows] for n, name in enumerate(PRESETS, 1)}
    names = [row[0] for row in rows]
    for name, config in PRESETS.items():
        fields = {
            f.name: bits(f) + (f": {f.number} x {f.width}" if f.number > 1 else "")
            for f in beat_fields(config)
            if f.name != "padding"
        }
        expected = fields | {"bytes on AXI": str(raster_stream_bytes(config))}
        assert names == list(expected)
        assert columns[name] == list(expected.values()), name


def test_tables():
    base, (width, height) = PAPER.register_base, PAPER.reset_size
    head, *rows = table("Tables")
    assert head == ["address", "data"]
    places = [
        f"0..{base - 1}",
        ", ".join(str(base + Register.AMBIENT_RED + n) for n in range(3)),
        *(str(base + each) for each in (Register.LAST_COLUMN, Register.LAST_LINE)),
        str(base + Register.CONTROL),
        f"{base + Register.CONTROL + 1}..{PAPER.table_address.mask}",
    ]
    assert [row[0] for row in rows] == places
    data = [row[1] for row in rows]
    assert f"{PAPER.coefficient_bits} bits each" in data[0]
    assert f"{PAPER.x_bits} bits. {width - 1} after reset" in data[2]
    assert f"{PAPER.line_bits} bits. {height - 1} after reset" in data[3]
    assert f"bit {Register.CONTROL_LOAD} set" in data[4]
    write = PAPER.table_address, PAPER.table_data
    assert "an {}-bit address and {} bits of data".format(*(f.width for f in write)) in PAGE


def test_colours():
    text = section("Colour")
    largest = (1 << PAPER.ambient_bits) - 1
    coefficient, intensity = ((1 << n) - 1 for n in (PAPER.coefficient_bits, PAPER.intensity_bits))
    total = largest + 2 * coefficient * intensity
    assert f">> {PAPER.colour_shift}, {PAPER.channel_max})" in text
    assert (
        f"kd and ks have {PAPER.coefficient_bits} bits, I0 has {PAPER.ambient_bits}, D and S have"
        f" {PAPER.intensity_bits}: the sum is at most {largest} + 2 * {coefficient} * {intensity}"
        f" = {total} and fits {total.bit_length()} bits."
    ) in text
    assert (
        f"the coefficients have {RGB24.coefficient_bits} bits, `colour_shift` is"
        f" {RGB24.colour_shift} and the sum saturates at {RGB24.channel_max}"
    ) in text
    b = PAPER.channel_bits
    assert f"{3 * b} bits: red in bits 0..{b - 1}, green in {b}..{2 * b - 1}, blue in" in text


@pytest.mark.parametrize("config", PRESETS.values(), ids=lambda config: config.name)
def test_a_sum_of_colours_fits_two_bits_more_than_coefficient_and_intensity(config):
    bits = config.coefficient_bits + config.intensity_bits
    products = 2 * ((1 << config.coefficient_bits) - 1) * ((1 << config.intensity_bits) - 1)
    assert ((1 << config.ambient_bits) - 1 + products).bit_length() <= bits + 2


def test_other_figures():
    assert f"its window: for {PAPER.clear_cycles} cycles in `paper`" in section("Reset")
    cycles = 3 * PAPER.block_words + 1
    assert f"a window of tiles ({cycles} in `paper`) and 2 in one of blocks" in section("Time")
    assert f"The background's depth is {PAPER.background_depth}" in section("Code words")
    assert f"takes a plane word as {codeword_stream_bytes(PLANE)} bytes" in section("On AXI")
