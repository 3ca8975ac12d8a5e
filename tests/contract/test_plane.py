import pytest

from splatline.contract.presets import PAPER, PLANE
from splatline.contract.variants import CONFIGS


def test_the_plane_word_lies_where_the_contract_says():
    positions = {
        "mode": (0, 0), "scans": (1, 24), "diffuse": (25, 31), "specular": (32, 38),
        "material": (39, 46), "x": (47, 55), "raised": (64, 64), "slope_x": (67, 73),
        "slope_y": (74, 80), "scale": (81, 82), "z": (83, 95),
    }  # fmt: skip
    for name, (low, high) in positions.items():
        field = getattr(PLANE, name)
        assert (field.lsb, field.end - 1) == (low, high), name
    assert [PLANE.side(row, end).lsb for row in range(4) for end in (0, 1)] == [*range(56, 64)]
    assert [PLANE.outwards(end).lsb for end in (0, 1)] == [65, 66]
    assert (PLANE.codeword_bits, PAPER.codeword_bits) == (96, 64)
    assert CONFIGS["plane"] is PLANE


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x_bits": 10}, "MODE to X of a plane word must have at most 56 bits, not 57"),
        ({"depth_bits": 13}, "a plane word must have at most 96 bits, not 97"),
        ({"slope_bits": 9}, "slope_bits must be an integer in 3..8, not 9"),
        ({"shapes": "small"}, "an engine with planes has no shape ROM"),
        ({"plane": 1}, "plane must be True or False, not 1"),
        ({"plane": False}, "the code word must have 64 bits, not 68"),
    ],
)
def test_a_plane_word_that_does_not_fit_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        PLANE.replace(**change)


def test_a_plane_word_holds_4096_columns_for_less_shading():
    wide = CONFIGS["plane-4096"]
    assert (wide.max_width, wide.max_height) == (4096, 4096)
    assert (wide.intensity_bits, wide.material_bits) == (6, 7)
    assert (wide.x.lsb, wide.x.end, wide.z.end) == (44, 56, 96)
    for name in ("side", "raised", "slope_x", "slope_y", "scale", "z"):
        one, other = getattr(wide, name), getattr(PLANE, name)
        assert name == "side" or (one.lsb, one.end) == (other.lsb, other.end)
