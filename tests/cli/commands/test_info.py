import json

import numpy as np
import pytest

from splatline.host.files import survey
from tests.host.files.las_files import las


def shown(result):
    """The printed tables as one line without borders."""
    text = result.stdout
    for border in "│┃":
        text = text.replace(border, " ")
    return " ".join(text.split())


def test_a_cloud_has_an_extent_a_spacing_and_fields(run, cloud):
    result = run("info", cloud, "--json")
    assert result.exit_code == 0, result.stderr
    facts = json.loads(result.stdout)
    points = np.loadtxt(cloud, delimiter=",", skiprows=1)
    assert facts["points"] == 2000
    assert facts["estimated_normals"] == 0
    np.testing.assert_allclose(facts["low"], points[:, :3].min(axis=0), atol=1e-5)
    np.testing.assert_allclose(facts["high"], points[:, :3].max(axis=0), atol=1e-5)
    np.testing.assert_allclose(facts["extent"], np.ptp(points[:, :3], axis=0), atol=1e-5)
    # 2000 points on a unit sphere: sqrt(4 pi / 2000) = 0.08 apart.
    assert 0.02 < facts["splat_size"] < 0.3
    red = facts["fields"][6]
    assert (red["name"], red["used_as"]) == ("red", "colour")
    assert (red["low"], red["high"]) == (points[:, 6].min(), points[:, 6].max())


def test_the_tables_have_the_same(run, cloud):
    text = shown(run("info", cloud))
    assert "format CSV, text in utf-8, values between ','" in text
    assert "points 2,000" in text
    assert "field type low high taken for" in text
    assert "nx number" in text
    assert "red number 0 255 colour" in text


def test_the_header_alone(run, cloud, tmp_path):
    text = shown(run("info", cloud, "--header"))
    assert "field type taken for" in text
    assert "x number position" in text
    assert "splat size" not in text
    assert "only the header was read" in text
    (tmp_path / "a.las").write_bytes(las(7))
    result = run("info", tmp_path / "a.las", "--header")
    text = shown(result)
    assert "format LAS 1.4, point format 7 points 60 system hand software hand" in text
    assert "low 654,318" in text
    facts = json.loads(run("info", tmp_path / "a.las", "--header", "--json").stdout)
    assert facts["splat_size"] is None
    assert len(facts["low"]) == 3


def test_a_large_file_needs_the_option_full(run, cloud, monkeypatch):
    monkeypatch.setattr(survey, "SMALL_TEXT", 1000)
    assert "splat size" not in shown(run("info", cloud))
    assert "splat size" in shown(run("info", cloud, "--full"))


@pytest.mark.parametrize("option", [[], ["--header"], ["--full"], ["--json"]])
@pytest.mark.parametrize("name", ["absent.ply", ".", "a.docx"])
def test_bad_input_gets_one_line_and_code_2(run, folder, option, name):
    (folder / "a.docx").write_text("no cloud")
    result = run("info", name, *option)
    assert result.exit_code == 2, (result.stderr, result.exception)
    told = [line for line in result.stderr.splitlines() if not line.endswith("...")]
    assert len(told) == 1
    assert told[0].startswith(f"splatline: {name}: ")
    assert not result.stdout


def test_the_format_may_be_given(run, folder):
    (folder / "points.dat").write_text("0 0 0\n1 0 0\n0 1 0\n")
    assert "unknown format '.dat'" in run("info", "points.dat").stderr
    facts = json.loads(run("info", "points.dat", "--format", "xyz", "--json").stdout)
    assert (facts["points"], facts["high"]) == (3, [1.0, 1.0, 0.0])
