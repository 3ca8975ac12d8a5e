"""The layout of a code word, in JSON and in the C header, against code words made otherwise."""

import json
import shutil
import subprocess

import numpy as np
import pytest

from splatline.contract.codeword_layout import (
    codeword_fields,
    codeword_stream_bytes,
    compact_fields,
)
from splatline.contract.presets import PAPER, PLANE, RGB24, SWIFT
from splatline.contract.register_map import register_map
from splatline.flow.register_texts import c_header, json_map
from splatline.flow.stream_texts import json_codeword
from tests.support import codewords, plane_words
from tests.support.rom_words import compact_words

CONFIGS = (PAPER, RGB24, SWIFT, *plane_words.CONFIGS)

PROGRAM = """
#include "splatline.h"
#include <inttypes.h>
#include <stdio.h>
int main(void)
{
    int64_t field[6 + 16], rest[7];
    while (fread(field, sizeof field, 1, stdin) == 1 && fread(rest, sizeof rest, 1, stdin) == 1) {
        uint64_t word[SPLATLINE_CODEWORD_LIMBS] = {0};
        SPLATLINE_CODEWORD_PUT(MODE, word, 0, (uint64_t)field[0]);
        for (unsigned row = 0; row < 4; row++) {
            uint64_t ends = (uint64_t)(field[6 + row] | field[10 + row] << 3);
            SPLATLINE_CODEWORD_PUT(SCANS, word, row, ends);
            if (SPLATLINE_CODEWORD_GET(SCANS, word, row) != ends)
                return 1;
        }
        SPLATLINE_CODEWORD_PUT(DIFFUSE, word, 0, (uint64_t)field[1]);
        SPLATLINE_CODEWORD_PUT(SPECULAR, word, 0, (uint64_t)field[2]);
        SPLATLINE_CODEWORD_PUT(MATERIAL, word, 0, (uint64_t)field[3]);
        SPLATLINE_CODEWORD_PUT(X, word, 0, (uint64_t)field[4]);
        SPLATLINE_CODEWORD_PUT(Z, word, 0, (uint64_t)field[5]);
        if ((int64_t)SPLATLINE_CODEWORD_GET(Z, word, 0) != field[5])
            return 2;
#ifdef SPLATLINE_CODEWORD_SCALE_LSB
        for (unsigned row = 0; row < 4; row++)
            SPLATLINE_CODEWORD_PUT(SIDES, word, row, (uint64_t)field[14 + row]);
        SPLATLINE_CODEWORD_PUT(RAISED, word, 0, (uint64_t)rest[0]);
        SPLATLINE_CODEWORD_PUT(OUTWARDS, word, 0, (uint64_t)rest[1]);
        SPLATLINE_CODEWORD_PUT(OUTWARDS, word, 1, (uint64_t)rest[2]);
        SPLATLINE_CODEWORD_PUT(SLOPE_X, word, 0, (uint64_t)rest[3]);
        SPLATLINE_CODEWORD_PUT(SLOPE_Y, word, 0, (uint64_t)rest[4]);
        SPLATLINE_CODEWORD_PUT(SCALE, word, 0, (uint64_t)rest[5]);
#endif
        fwrite(word, SPLATLINE_CODEWORD_BYTES, 1, stdout);
    }
    return 0;
}
"""
"""Reads the fields of code words as numbers of 64 bits, and writes the code words."""


COMPACT_PROGRAM = """
#include "splatline.h"
#include <stdio.h>
int main(void)
{
    uint64_t field[5];
    while (fread(field, sizeof field, 1, stdin) == 1) {
        uint64_t word[SPLATLINE_COMPACT_LIMBS] = {0};
        SPLATLINE_COMPACT_PUT(SIZE, word, 0, field[0]);
        SPLATLINE_COMPACT_PUT(LEVEL_X, word, 0, field[1]);
        SPLATLINE_COMPACT_PUT(LEVEL_Y, word, 0, field[2]);
        SPLATLINE_COMPACT_PUT(PART, word, 0, field[3]);
        SPLATLINE_COMPACT_PUT(X, word, 0, field[4]);
        SPLATLINE_COMPACT_PUT(MARK, word, 0, 2);
        if (SPLATLINE_COMPACT_GET(LEVEL_Y, word, 0) != field[2])
            return 1;
        fwrite(word, SPLATLINE_COMPACT_BYTES, 1, stdout);
    }
    return 0;
}
"""
"""Reads the fields of compact words as numbers of 64 bits, and writes the words."""


def random_fields(rng, config):
    """Return a code word, by the encoders of the tests, and the numbers that the program reads."""
    module = plane_words if config.plane else codewords
    rows = [tuple(pair) for pair in rng.integers(0, 8, (4, 2)).tolist()]
    mode = int(rng.integers(2))
    names = ("d", "s", "m", "x", "z")
    limits = {"d": config.intensity_bits, "s": config.intensity_bits, "m": config.material_bits,
              "x": config.x_bits, "z": config.depth_bits + config.plane}  # fmt: skip
    values = {name: int(rng.integers(1 << limits[name])) for name in names}
    numbers = [mode, *values.values(), *(row[0] for row in rows), *(row[1] for row in rows)]
    sides, rest = [0] * 8, [0] * 7
    if config.plane:
        half = 1 << config.slope_bits - 1
        sides[:4] = rng.integers(0, 4, 4).tolist()
        raised, first_out, last_out = rng.integers(0, 2, 3).tolist()
        a, b = rng.integers(-half, half, 2).tolist()
        scale = int(rng.integers(4))
        rest[:6] = raised, first_out, last_out, a, b, scale
        names = ("raised", "first_out", "last_out", "a", "b", "scale")
        values |= dict(zip(names, rest[:6], strict=True))
        values["sides"] = sum(pair << 2 * row for row, pair in enumerate(sides[:4]))
    word = module.encode(rows, mode=mode, config=config, **values)
    return word, [*numbers, *sides, *rest]


def run_program(text, config, numbers, folder):
    """Compile a program with an engine's header; return what it writes of the numbers."""
    (folder / "splatline.h").write_text(c_header(register_map(config)))
    (folder / "main.c").write_text(text)
    compiler = shutil.which("gcc") or shutil.which("cc")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([compiler, *flags, "main.c", "-o", "main"], cwd=folder, check=True)
    sent = numbers.tobytes()
    return subprocess.run([folder / "main"], input=sent, check=True, capture_output=True).stdout


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
def test_the_c_header_packs_code_words(config, tmp_path):
    """Byte by byte what the encoders of the tests make, which know the contract alone."""
    rng = np.random.default_rng(1)
    words, numbers = zip(*(random_fields(rng, config) for _ in range(200)), strict=True)
    packed = run_program(PROGRAM, config, np.array(numbers, "<i8"), tmp_path)
    size = 16 if config.plane else 8
    assert codeword_stream_bytes(config) == size
    assert packed == b"".join(word.to_bytes(size, "little") for word in words)


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.name)
def test_the_fields_of_a_code_word_fill_its_stream_without_a_gap(config):
    codeword = json.loads(json.dumps(json_codeword(config)))
    place = 0
    for field in codeword["fields"]:
        assert field["lsb"] == place
        place += field["number"] * field["width"]
    assert place == 8 * codeword["stream_bytes"]
    assert codeword["bits"] == (96 if config.plane else 64)
    assert json_map(register_map(config))["codeword"] == codeword


@pytest.mark.parametrize("config", [PAPER, RGB24, SWIFT], ids=lambda c: c.name)
def test_the_fields_of_compact_words_lie_where_they_are_said_to(config):
    rng = np.random.default_rng(11)
    config = config.with_shapes()
    fields = {f.name: f for f in compact_fields(config)}
    for _ in range(50):
        limits = {"size": 17, "level_x": 64, "level_y": 64, "part": 4}
        values = {name: int(rng.integers(limit)) for name, limit in limits.items()}
        rest = {name: int(rng.integers(1 << fields[name].width)) for name in list(fields)[6:]}
        above = sum(value << fields[name].lsb for name, value in rest.items())
        word = int(np.ravel(compact_words(config, *values.values(), rest=above))[0])
        for name, value in {**values, **rest, "mode": 0, "mark": 0b00010}.items():
            assert word >> fields[name].lsb & (1 << fields[name].width) - 1 == value, name
    assert sum(f.width for f in fields.values()) == 64


def test_an_engine_without_a_shape_rom_has_no_compact_words():
    for config in (PAPER, PLANE):
        with pytest.raises(ValueError, match="has no shape ROM"):
            compact_fields(config)
    assert "compact_fields" not in json_codeword(PAPER)
    assert "SPLATLINE_COMPACT_SIZE" not in c_header(register_map(PAPER))


@pytest.mark.parametrize("config", [PAPER, RGB24, SWIFT], ids=lambda c: c.name)
def test_the_c_header_and_the_json_have_compact_words(config, tmp_path):
    """Byte by byte what the encoder of the tests makes."""
    rng = np.random.default_rng(12)
    config = config.with_shapes()
    numbers = rng.integers(0, [17, 64, 64, 4, 512], (100, 5), np.uint64)
    packed = run_program(COMPACT_PROGRAM, config, numbers.astype("<u8"), tmp_path)
    x = next(field for field in codeword_fields(config) if field.name == "x")
    words = [
        np.ravel(compact_words(config, *row[:4], rest=row[4] << x.lsb))[0]
        for row in numbers.tolist()
    ]
    assert packed == np.array(words, "<u8").tobytes()
    written = json.loads(json.dumps(json_codeword(config)))["compact_fields"]
    assert written == [field._asdict() for field in compact_fields(config)]
