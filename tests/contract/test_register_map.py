import dataclasses
import json
import shutil
import subprocess
from pathlib import Path

import pytest
from amaranth.sim import Simulator

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import MOST_BEAT_BITS, WINDOWS, EngineConfig
from splatline.contract.presets import DEFAULT, PAPER, PLANE, PRESETS, SWIFT
from splatline.contract.register_map import PARAMETERS, VERSION, register_map
from splatline.contract.register_types import Access
from splatline.contract.variants import VARIANTS
from splatline.flow.register_texts import c_header, json_map, markdown
from splatline.rtl.front.tables import Tables

CONFIGS = {config.name: config for config in (*PRESETS.values(), *VARIANTS, PLANE)}
WIDEST = EngineConfig(
    name="widest", intensity_bits=1, material_bits=9, x_bits=12, depth_bits=16, line_bits=14,
    channel_bits=8, coefficient_bits=12, colour_shift=13,
)  # fmt: skip
WIDEST_BEAT = WIDEST.replace(
    name="widest-beat", window="blocks", window_lines=32, pixels_per_word=8, raster_words=2
)


@pytest.mark.parametrize("config", [*CONFIGS.values(), WIDEST], ids=lambda config: config.name)
def test_the_size_after_a_reset_is_the_engine_s(config):
    """512 x 512, or as many as there can be, as docs/contract.md says."""
    registers, tables = register_map(config), Tables(config)
    said = [registers[name]["VALUE"].reset for name in ("LAST_COLUMN", "LAST_LINE")]

    async def read(context):
        size = (tables.registers.last_column, tables.registers.last_line)
        assert [context.get(last) for last in size] == said

    simulation = Simulator(tables)
    simulation.add_testbench(read)
    simulation.run()
    assert said == [min(512, most) - 1 for most in (config.max_width, config.max_height)]


@pytest.mark.parametrize(
    "config", [*CONFIGS.values(), WIDEST, WIDEST_BEAT], ids=lambda config: config.name
)
def test_nothing_overlaps_and_all_lies_within(config):
    registers = register_map(config)
    taken = set()
    for register in registers.registers:
        assert register.offset % 4 == 0
        assert register.offset not in taken
        taken.add(register.offset)
        bits = 0
        for field in register.fields:
            assert bits & field.mask == 0
            bits |= field.mask
            assert field.reset <= field.place.mask
            assert field.meaning
        assert bits < 1 << 32
    window = registers.materials
    assert max(taken) < window.offset
    assert window.stride >= 4 * window.words
    assert window.offset + window.entries * window.stride <= 1 << registers.address_bits
    assert window.bits == 6 * config.coefficient_bits == config.table_data.width
    assert [bin(mask).count("1") for mask in window.writable] == [
        min(32, window.bits - 32 * word) for word in range(window.words)
    ]


def test_the_widest_beat_there_is_fits_its_stream():
    """Every width is at its most, and the stream is one of 1024 bits."""
    stream = register_map(WIDEST_BEAT)["CONFIG_1"]["BEAT_BYTES"].reset
    assert (WIDEST_BEAT.raster_end.end, 8 * stream) == (663, MOST_BEAT_BITS)


def test_the_map_is_of_version_2_and_names_the_window():
    """What version 1 had of it in bits of their own, and what it had besides, is gone."""
    for config, number in ((PAPER, 0), (PRESETS["rgb24"], 0), (SWIFT, 1)):
        registers = register_map(config)
        version = registers["VERSION"]
        assert (version["MAJOR"].reset, version["MINOR"].reset) == VERSION == (2, 0)
        assert registers["CONFIG_0"]["WINDOW"].reset == number
        assert list(WINDOWS)[number] == config.window
        names = {f.name for n in (0, 1) for f in registers[f"CONFIG_{n}"].fields}
        assert not names & {"LANES", "BANKS", "DITHER", "COLOUR_PLANES", "MARK_WORDS"}


@pytest.mark.parametrize("config", [*CONFIGS.values(), WIDEST_BEAT], ids=lambda c: c.name)
def test_a_beat_is_whole_limbs(config):
    size = raster_stream_bytes(config)
    assert size & (size - 1) == 0
    assert size >= 8
    assert config.raster_end.end <= 8 * size < 2 * max(config.raster_end.end, 33)


def test_the_config_registers_hold_every_parameter_of_the_engine():
    named = {name for widths in PARAMETERS for name in widths} - {"beat_bytes"}
    fields = {field.name for field in dataclasses.fields(EngineConfig)}
    assert named == fields - {"name", "memory"}  # its pictures are the same with any memories


def test_an_engine_with_planes_has_version_3():
    """A driver of version 2 refuses it, and would send it words of 64 bits otherwise."""
    version = register_map(PLANE)["VERSION"]
    assert (version["MAJOR"].reset, version["MINOR"].reset) == (3, 0)


def test_planes_are_told_in_bits_that_are_0_in_other_engines():
    """So the registers of engines without planes are those of before, and so is their hardware."""
    for config in CONFIGS.values():
        fields = [(f.name, f.place.lsb) for f in register_map(config)["CONFIG_1"].fields[-3:]]
        assert fields == [("BEAT_BYTES", 19), ("PLANE", 27), ("SLOPE_BITS", 28)]
        values = [field.reset for field in register_map(config)["CONFIG_1"].fields[-2:]]
        assert values == ([1, config.slope_bits] if config.plane else [0, 0])


def test_the_page_in_docs_is_that_of_the_default_preset():
    """``splatline registers --markdown docs/registers.md`` makes it."""
    page = Path(__file__).parents[2] / "docs" / "registers.md"
    assert page.read_text() == markdown(register_map(DEFAULT))


@pytest.mark.parametrize("config", [PAPER, PRESETS["rgb24"], WIDEST, PLANE], ids=lambda c: c.name)
def test_the_c_header_compiles_alone_and_says_the_same(config, tmp_path):
    """Every number of the map, printed by a program that has the header twice."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler, "building the simulator needs one too"
    registers = register_map(config)
    expected, names = [], []
    for register in registers.registers:
        names.append(f"{register.name}_OFFSET")
        expected.append(register.offset)
        for field in register.fields:
            names += [f"{register.name}_{field.name}_{what}" for what in ("SHIFT", "MASK")]
            expected += [field.place.lsb, field.mask]
            if not field.live and field.access is not Access.WRITE_ONLY:
                names.append(f"{register.name}_{field.name}_RESET")
                expected.append(field.reset)
    window = registers.materials
    for what in ("OFFSET", "ENTRIES", "STRIDE", "WORDS"):
        names.append(f"MATERIAL_{what}")
        expected.append(getattr(window, what.lower()))
    for field in window.fields:
        names += [f"MATERIAL_{field.name}_BIT", f"MATERIAL_{field.name}_WIDTH"]
        expected += [field.place.lsb, field.place.width]
    prints = "\n".join(f'printf("%u\\n", SPLATLINE_{name});' for name in names)
    (tmp_path / "splatline.h").write_text(c_header(registers))
    (tmp_path / "main.c").write_text(
        '#include "splatline.h"\n#include "splatline.h"\n#include <stdio.h>\n'
        f"int main(void) {{ {prints}\n"
        'printf("%u %u\\n", SPLATLINE_GET(CONFIG_0_DEPTH_BITS, 0xffffffffu),'
        " SPLATLINE_PUT(CONTROL_ABORT, 1u)); return 0; }\n"
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(
        [compiler, *flags, "main.c", "-o", "main"], cwd=tmp_path, check=True, capture_output=True
    )
    said = subprocess.run(
        [tmp_path / "main"], check=True, capture_output=True, text=True
    ).stdout.splitlines()
    assert [int(line) for line in said[:-1]] == expected
    assert said[-1] == f"31 {1 << registers['CONTROL']['ABORT'].place.lsb}"


def compare_fields(rows, fields):
    """What the JSON map says of fields is what the map has; no reset is told of what is not one."""
    for row, field in zip(rows, fields, strict=True):
        assert (row["name"], row["meaning"]) == (field.name, field.meaning)
        assert (row["lsb"], row["width"]) == (field.place.lsb, field.place.width)
        assert row["access"] == field.access.value
        known = not field.live and field.access is not Access.WRITE_ONLY
        assert row.get("reset") == (field.reset if known else None)


@pytest.mark.parametrize("config", [PAPER, PRESETS["rgb24"], WIDEST, PLANE], ids=lambda c: c.name)
def test_the_json_map_has_every_register_and_field(config):
    registers = register_map(config)
    found = json.loads(json.dumps(json_map(registers)))
    assert (found["preset"], found["bytes"]) == (config.name, 1 << registers.address_bits)
    for row, register in zip(found["registers"], registers.registers, strict=True):
        for key in ("name", "offset", "meaning", "between_frames"):
            assert row[key] == getattr(register, key)
        compare_fields(row["fields"], register.fields)
    for key in ("offset", "entries", "stride", "words"):
        assert found["materials"][key] == getattr(registers.materials, key)
    compare_fields(found["materials"]["fields"], registers.materials.fields)
    raster_bytes = {"paper": 16, "rgb24": 32, "widest": 32, "plane": 32}[config.name]
    codeword_bytes = 16 if config.plane else 8
    assert found["streams"] == {"codeword_bytes": codeword_bytes, "raster_bytes": raster_bytes}


def test_registers_that_reach_too_far_are_refused():
    registers = register_map(PAPER)
    far = dataclasses.replace(registers.registers[-1], offset=0x80)
    with pytest.raises(ValueError, match="a register at 0x80: they must lie below 0x80"):
        dataclasses.replace(registers, registers=(*registers.registers, far))
