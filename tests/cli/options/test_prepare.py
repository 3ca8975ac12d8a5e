"""Estimated normals of a survey that is seen from above, through ``splatline render``."""

import json

import numpy as np
import pytest

from tests.host.large.test_draw_parts import hills, write_las


@pytest.fixture
def scan(folder):
    return write_las(folder / "hills.las", *hills(20_000, 7))


def facing_away(run, folder, *arguments):
    """Return how many points are left out as they face away, and whether there are parts."""
    result = run("render", *arguments, "--size", "96x96", "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    numbers = json.loads((folder / "a.json").read_text())
    return numbers["culled"]["facing_away"], "parts" in numbers


@pytest.mark.parametrize("parts", [[], ["--memory", "501M"]])
def test_far_slopes_of_a_survey_are_left_out_from_above_alone(run, folder, scan, parts):
    count, in_parts = facing_away(run, folder, scan, "--orbit", "30,15", *parts)
    assert count > 200
    assert in_parts == bool(parts)
    assert facing_away(run, folder, scan, "--orbit", "30,-15", *parts) == (0, in_parts)


def test_other_formats_keep_both_sides(run, folder):
    np.save(folder / "hills.npy", hills(20_000, 7)[0])
    assert facing_away(run, folder, "hills.npy", "--up", "z", "--orbit", "30,15") == (0, False)
