"""``splatline bench view``: a real server and a real client."""

import json

import pytest
from click.testing import CliRunner

from splatline.cli.bench.view.page import write_page
from splatline.cli.main import main


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("view") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("splatline.host.scenes.scenes.SCENES", ())
        arguments = ["--size", "64x48", "--points", "3000", "--seconds", "0.3", "--steps", "3"]
        result = CliRunner().invoke(main, ["bench", "view", *arguments, "--out-dir", str(folder)])
    assert result.exit_code == 0, result.output
    return folder, result


def test_a_cloud_has_its_rates_and_the_bound(outcome):
    folder, _ = outcome
    report = json.loads((folder / "view.json").read_text())
    [run] = report["runs"]
    assert (run["cloud"], run["points"]) == ("knot, 3,000 points", 3000)
    assert run["fps"] > 1.0
    assert 0.0 <= run["full"] <= 1.0
    assert 0.0 < run["latency_ms"] <= run["latency_95_ms"]
    assert run["draw_ms"] > 0.0
    assert run["processor_ms"] >= 0.0


def test_the_page_says_what_was_made_how_and_whether_the_goals_are_met(outcome):
    folder, result = outcome
    page = (folder / "view.md").read_text()
    assert page.strip() in result.output
    assert "`splatline bench view`: 64 x 48 pixels" in page
    assert "| knot, 3,000 points | 3,000 |" in page


@pytest.mark.parametrize(
    ("fps", "latency", "verdict"),
    [(30.0, 79.9, "met"), (29.9, 10.0, "missed"), (60.0, 80.0, "missed")],
)
def test_both_goals_must_be_met(outcome, fps, latency, verdict):
    folder, _ = outcome
    report = json.loads((folder / "view.json").read_text())
    report["runs"][0] |= {"fps": fps, "latency_ms": latency, "processor_ms": None}
    assert f"80 ms: {verdict}" in write_page(report)
