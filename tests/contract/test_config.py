import pytest

from splatline.contract.config import BLOCK, EngineConfig
from splatline.contract.presets import PAPER, PRESETS, get_preset
from splatline.contract.variants import ALL_OF_EIGHT, SHAPED, VARIANTS
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout


def test_the_paper_s_code_word_is_the_one_of_its_figure_4():
    positions = {
        "mode": (0, 0),
        "scans": (1, 24),
        "diffuse": (25, 31),
        "specular": (32, 38),
        "material": (39, 45),
        "x": (46, 54),
        "z": (55, 63),
    }
    for name, (low, high) in positions.items():
        field = getattr(PAPER, name)
        assert (field.lsb, field.end - 1) == (low, high), name
    assert [PAPER.first(k).lsb for k in range(4)] == [1, 7, 13, 19]
    assert [PAPER.last(k).lsb for k in range(4)] == [4, 10, 16, 22]
    assert PAPER.control_end.lsb == 25


@pytest.mark.parametrize(
    "config", [*PRESETS.values(), *SHAPED, *VARIANTS, *ALL_OF_EIGHT], ids=lambda config: config.name
)
def test_the_hardware_s_layouts_lie_where_the_format_says(config):
    word = CodeWordLayout(config)
    assert word.size == 64
    for name in ("mode", "scans", "diffuse", "specular", "material", "x", "z"):
        field = getattr(config, name)
        assert (word[name].offset, word[name].width) == (field.lsb, field.width)
    beat = RasterLayout(config)
    assert beat.size == config.raster_end.end
    for name in ("word", "line", "end"):
        field = getattr(config, f"raster_{name}")
        assert (beat[name].offset, beat[name].width) == (field.lsb, field.width)
    pixels = beat["pixels"].shape
    for kind, locate in (("depth", config.raster_depth), ("colour", config.raster_colour)):
        for pixel in range(config.pixels_per_word):
            offset = pixels[kind].offset + pixels[kind].shape[pixel].offset
            assert offset == locate(pixel).lsb
    write = TableWriteLayout(config)
    assert write["address"].offset == config.table_address.lsb
    assert write.size == config.table_address.end


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"depth_bits": 0}, "depth_bits must be an integer in 1..16, not 0"),
        ({"depth_bits": 9.0}, "depth_bits must be an integer in 1..16, not 9.0"),
        ({"channel_bits": 9}, "channel_bits must be an integer in 1..8, not 9"),
        ({"colour_shift": 14}, "colour_shift must be an integer in 1..13, not 14"),
        ({"colour_shift": 3, "dither": True}, "colour_shift must be an integer in 4..13, not 3"),
        ({"colour_planes": 0}, "colour_planes must be an integer in 1..3, not 0"),
        ({"colour_planes": 4}, "colour_planes must be an integer in 1..3, not 4"),
        ({"material_bits": 2}, "material_bits must be an integer in 3..9, not 2"),
        ({"window_lines": 8}, "window_lines must be 16 with 8 banks, not 8"),
        ({"pixels_per_word": 8}, "pixels_per_word must be 4 with 8 banks, not 8"),
        (
            {"pixels_per_word": 2, "banks": 16},
            "pixels_per_word must be 4 or 8 with 16 banks, not 2",
        ),
        ({"banks": 4}, "banks must be 8 or 16, not 4"),
        (
            {"lanes": True, "banks": 16, "raster_words": 2},
            "pixels_per_word must be 8 with 16 banks of lanes, not 4",
        ),
        (
            {"lanes": True, "banks": 16, "pixels_per_word": 8},
            "raster_words must be 2 with 16 banks of lanes, not 1",
        ),
        (
            {"lanes": True, "window_lines": 12},
            "window_lines must be 8, 16 or 32 with lanes, not 12",
        ),
        (
            {"lanes": True, "pixels_per_word": 3},
            "pixels_per_word must be 2, 4 or 8 with lanes, not 3",
        ),
        (
            {"lanes": True, "pixels_per_word": 8, "x_bits": 4},
            "x_bits must be at least 5 for 8 pixels a word, not 4",
        ),
        ({"shapes": "round"}, "shapes must be none, small, full, not 'round'"),
        ({"banks": 16.0}, "banks must be 8 or 16, not 16.0"),
        ({"pixels_per_word": 4.0}, "pixels_per_word must be 4 with 8 banks, not 4.0"),
        (
            {"pixels_per_word": 8.0, "banks": 16},
            "pixels_per_word must be 4 or 8 with 16 banks, not 8.0",
        ),
        ({"raster_words": 2.0}, "raster_words must be 1 or 2 with 8 banks, not 2.0"),
        ({"mark_words": 2.0}, "mark_words must be 1, 2, 4 or 8, not 2.0"),
        ({"depth_bits": 10}, "the code word must have 64 bits, not 65"),
        (
            {"banks": 16, "pixels_per_word": 8, "raster_words": 2, "channel_bits": 8},
            "a beat of the raster must have at most 512 bits, not 544",
        ),
    ],
)
def test_bad_parameters_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        EngineConfig(**change)


def test_planes_hold_a_whole_colour():
    for config in PRESETS.values():
        used = config.colour_planes * config.plane_bits
        assert 0 <= used - config.colour_bits < config.colour_planes
        if config.colour_planes > 1:  # a half of a bank's block RAM has ports of 36 bits
            assert config.pixels_per_word * config.plane_bits <= 36
    planes = {config.name: config.plane_bits for config in PRESETS.values()}
    assert planes == {
        "paper": 9,
        "wide": 9,
        "swift": 9,
        "dither": 9,
        "rgb18": 9,
        "rgb24": 8,
        "deep": 9,
    }


def test_an_element_touches_so_many_words():
    """Of nine columns: at a half place, turned rows reach the one beside the block."""
    for pixels in (2, 4, 8):
        most = max((offset + BLOCK) // pixels + 1 for offset in range(pixels))
        assert PAPER.replace(pixels_per_word=pixels).block_words == most


def test_presets_are_found_by_name():
    assert get_preset("paper") is PAPER
    with pytest.raises(ValueError, match="no preset named 'large'; there are: deep, dither, paper"):
        get_preset("large")
    assert PAPER.replace(depth_bits=8, x_bits=10).name == "custom"


def test_a_compact_word_s_fields_lie_side_by_side_in_the_scans():
    """In every configuration in the same place, which the host's compiled code relies on."""
    for config in (*PRESETS.values(), *SHAPED, *VARIANTS):
        fields = [config.compact_size, config.compact_level_x, config.compact_level_y,
                  config.compact_part]  # fmt: skip
        assert [(field.lsb, field.end) for field in fields] == [(1, 6), (6, 12), (12, 18), (18, 20)]
        assert (config.compact_mark.lsb, config.compact_mark.end) == (20, 25)


def test_a_rom_is_added_once():
    assert PAPER.with_shapes().name == "paper-rom"
    assert PAPER.with_shapes().with_shapes("full") == PAPER.with_shapes()
    assert PAPER.with_shapes("full").largest_shape == 16
    assert PAPER.largest_shape < 0
