import pytest

from splatline.contract import config as config_module
from splatline.contract.config import BLOCK, EngineConfig
from splatline.contract.presets import DEFAULT, LANES8, PAPER, PRESETS, REMOVED, SWIFT, get_preset
from splatline.contract.variants import NARROW_BLOCKS, SHAPED, VARIANTS
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout

BLOCKS = {"window": "blocks", "window_lines": 16, "pixels_per_word": 8, "raster_words": 2}


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
    "config", [*PRESETS.values(), *SHAPED, *VARIANTS, NARROW_BLOCKS], ids=lambda config: config.name
)
def test_the_hardware_s_layouts_lie_where_the_format_says(config):
    word = CodeWordLayout(config)
    assert word.size == config.codeword_bits == (96 if config.plane else 64)
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
        ({"material_bits": 2}, "material_bits must be an integer in 3..9, not 2"),
        ({"window": "banks"}, "window must be tiles or blocks, not 'banks'"),
        ({"window": True}, "window must be tiles or blocks, not True"),
        ({"window_lines": 12}, "window_lines must be 8, 16 or 32 with tiles, not 12"),
        ({"pixels_per_word": 3}, "pixels_per_word must be 2, 4 or 8 with tiles, not 3"),
        ({"pixels_per_word": 4.0}, "pixels_per_word must be 2, 4 or 8 with tiles, not 4.0"),
        ({"raster_words": 2}, "raster_words must be 1 with tiles, not 2"),
        (
            {"pixels_per_word": 8, "x_bits": 4},
            "x_bits must be at least 5 for 8 pixels a word, not 4",
        ),
        ({**BLOCKS, "window_lines": 8}, "window_lines must be 16 or 32 with blocks, not 8"),
        ({**BLOCKS, "pixels_per_word": 4}, "pixels_per_word must be 8 with blocks, not 4"),
        ({**BLOCKS, "raster_words": 1}, "raster_words must be 2 with blocks, not 1"),
        ({**BLOCKS, "raster_words": 2.0}, "raster_words must be 2 with blocks, not 2.0"),
        ({"memory": "single"}, "memory must be dual or simple, not 'single'"),
        ({**BLOCKS, "memory": "simple"}, "memory must be dual with blocks, not 'simple'"),
        ({"shapes": "round"}, "shapes must be none, small, full, not 'round'"),
        ({"depth_bits": 10}, "the code word must have 64 bits, not 65"),
    ],
)
def test_bad_parameters_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        EngineConfig(**change)


def test_memories_change_a_name_and_no_field():
    simple = LANES8.with_memory("simple")
    assert (simple.name, simple.memory, simple.flush_words) == ("lanes8-simple", "simple", 1)
    assert simple.replace(name="lanes8", memory="dual") == LANES8
    assert simple.with_memory("simple") is simple
    assert simple.with_memory("dual") == LANES8
    assert PAPER.with_memory("dual") is PAPER


@pytest.mark.parametrize("name", ["lanes", "banks", "colour_planes", "mark_words", "dither"])
def test_parameters_of_earlier_versions_are_gone(name):
    with pytest.raises(TypeError, match=f"unexpected keyword argument {name!r}"):
        PAPER.replace(**{name: 1})


def test_a_beat_that_is_too_wide_for_a_stream_is_refused(monkeypatch):
    """None is yet: see the widest one in test_register_map."""
    monkeypatch.setattr(config_module, "MOST_BEAT_BITS", SWIFT.raster_end.end - 1)
    with pytest.raises(ValueError, match="of the raster must have at most 543 bits, not 544"):
        SWIFT.replace(name="refused")


def test_an_element_touches_so_many_words():
    """Of nine columns: at a half pixel, turned rows reach the one beside the block."""
    for pixels in (2, 4, 8):
        most = max((offset + BLOCK) // pixels + 1 for offset in range(pixels))
        assert PAPER.replace(pixels_per_word=pixels).block_words == most


def test_presets_are_found_by_name():
    for name, config in PRESETS.items():
        assert get_preset(name) is config
        assert config.name == name
    with pytest.raises(ValueError, match=r"no preset named 'large'; there are: lanes8, .*-plane$"):
        get_preset("large")
    assert PAPER.replace(depth_bits=8, x_bits=10).name == "custom"


def test_the_default_has_24_bit_colour_and_the_paper_s_code_word():
    assert DEFAULT is PRESETS["rgb24"]
    assert DEFAULT.colour_bits == 24
    for name in ("mode", "scans", "diffuse", "specular", "material", "x", "z"):
        assert getattr(DEFAULT, name) == getattr(PAPER, name)


@pytest.mark.parametrize(("name", "instead"), REMOVED.items())
def test_a_removed_preset_says_what_to_take_instead(name, instead):
    with pytest.raises(ValueError) as raised:
        get_preset(name)
    assert str(raised.value) == f"preset {name!r} was removed; take {instead}"
    assert name not in PRESETS
    assert name not in {config.name for config in (*VARIANTS, *SHAPED)}


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
