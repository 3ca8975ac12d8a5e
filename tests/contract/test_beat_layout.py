"""The layout of a raster beat, in JSON and in the C header, against the beats themselves."""

import json
import shutil
import subprocess

import numpy as np
import pytest

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.presets import PLANE, PRESETS
from splatline.contract.raster_beats import to_beats
from splatline.contract.register_map import register_map
from splatline.flow.register_texts import c_header, json_map
from splatline.flow.stream_texts import json_beat
from tests.support.random_frames import random_raster

WIDEST_BEAT = EngineConfig(
    name="widest-beat", intensity_bits=1, material_bits=9, x_bits=12, depth_bits=16, line_bits=14,
    channel_bits=8, coefficient_bits=12, colour_shift=13, window="blocks", window_lines=32,
    pixels_per_word=8, raster_words=2,
)  # fmt: skip
CONFIGS = [*(PRESETS | {"plane": PLANE}).values(), WIDEST_BEAT]

PROGRAM = """
#include "splatline.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
int main(void)
{
    uint64_t beat[SPLATLINE_BEAT_LIMBS], again[SPLATLINE_BEAT_LIMBS];
    while (fread(beat, SPLATLINE_BEAT_BYTES, 1, stdin) == 1) {
        memset(again, 0, sizeof again);
        for (unsigned n = 0; n < SPLATLINE_BEAT_PIXELS; n++) {
            uint64_t colour = SPLATLINE_BEAT_GET(COLOUR, beat, n);
            uint64_t depth = SPLATLINE_BEAT_GET(DEPTH, beat, n);
            SPLATLINE_BEAT_PUT(COLOUR, again, n, colour);
            SPLATLINE_BEAT_PUT(DEPTH, again, n, depth);
            printf("%" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " ", depth,
                SPLATLINE_COLOUR_RED(colour), SPLATLINE_COLOUR_GREEN(colour),
                SPLATLINE_COLOUR_BLUE(colour));
        }
        SPLATLINE_BEAT_PUT(WORD, again, 0, SPLATLINE_BEAT_GET(WORD, beat, 0));
        SPLATLINE_BEAT_PUT(LINE, again, 0, SPLATLINE_BEAT_GET(LINE, beat, 0));
        SPLATLINE_BEAT_PUT(END, again, 0, SPLATLINE_BEAT_GET(END, beat, 0));
        printf("%u %u %u\\n", (unsigned)SPLATLINE_BEAT_GET(WORD, beat, 0),
            (unsigned)SPLATLINE_BEAT_GET(LINE, beat, 0),
            (unsigned)SPLATLINE_BEAT_GET(END, beat, 0));
        if (memcmp(beat, again, sizeof beat))
            return 1;
    }
    return 0;
}
"""
"""Reads beats, prints their fields, and packs them again."""


@pytest.mark.parametrize("config", CONFIGS, ids=lambda c: c.name)
def test_the_c_header_unpacks_and_packs_beats(config, tmp_path):
    """A program reads beats, prints their fields and packs them again."""
    rng = np.random.default_rng(1)
    width, height, pixels = 3 * config.raster_pixels, 5, config.raster_pixels
    raster = random_raster(rng, width, height, 0.4, config)
    beats = to_beats(raster)
    (tmp_path / "splatline.h").write_text(c_header(register_map(config)))
    (tmp_path / "main.c").write_text(PROGRAM)
    compiler = shutil.which("gcc") or shutil.which("cc")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([compiler, *flags, "main.c", "-o", "main"], cwd=tmp_path, check=True)
    size = raster_stream_bytes(config) // 8
    stream = np.pad(beats, ((0, 0), (0, size - beats.shape[1]))).astype("<u8").tobytes()
    said = subprocess.run([tmp_path / "main"], input=stream, check=True, capture_output=True).stdout
    rows = np.array([line.split() for line in said.decode().splitlines()], np.int64)
    *drawn, end = rows
    assert end[-1] == 1
    assert len(rows) == len(beats)
    for row in drawn:
        word, line, more = row[-3:]
        columns = slice(word * pixels, (word + 1) * pixels)
        found = row[:-3].reshape(pixels, 4)
        assert more == 0
        assert np.array_equal(found[:, 0], raster.depth[line, columns])
        assert np.array_equal(found[:, 1:], raster.colour[line, columns])


@pytest.mark.parametrize("config", CONFIGS, ids=lambda c: c.name)
def test_the_fields_of_a_beat_fill_its_stream_without_a_gap(config):
    beat = json.loads(json.dumps(json_beat(config)))
    place = 0
    for field in beat["fields"]:
        assert field["lsb"] == place
        place += field["number"] * field["width"]
    assert place == 8 * beat["stream_bytes"]
    assert json_map(register_map(config))["beat"] == beat


def test_a_beat_of_12_bit_depths_is_32_bytes():
    """Four pixels of 36 bits, and the place."""
    assert json_beat(PLANE)["bits"] == 4 * 36 + 7 + 10 + 1
    assert json_beat(PLANE)["stream_bytes"] == 32
