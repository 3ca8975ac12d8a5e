import json

import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.bench.surface import measure as bench_surface
from splatline.cli.main import main


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("surface")
    ball = np.random.default_rng(1).normal(size=(3000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    np.savetxt(folder / "ball.xyzn", np.hstack([ball, ball]))
    arguments = ["--quick", "--size", "48x40", "--out-dir", str(folder / "out")]
    result = CliRunner().invoke(main, ["bench", "surface", str(folder / "ball.xyzn"), *arguments])
    assert result.exit_code == 0, result.output
    return folder / "out", result


def test_every_case_is_measured_and_tabulated(outcome):
    folder, result = outcome
    report = json.loads((folder / "surface.json").read_text())
    assert len(report["runs"]) == 2 * 2 * 2 * 2 * 3
    for run in report["runs"]:
        assert 0.0 <= run["pinholes"] < 0.2 and 0.0 <= run["behind_truth"] <= 1.0
        assert run["psnr_db"] > 5.0
    page = (folder / "surface.md").read_text()
    assert page in result.stdout
    assert "## knot, points spread evenly" in page and "## terrain, points at random" in page
    clouds = page.split("## Clouds")[1]
    for name, points in ("ball", 3000), ("ball, dense", 12_000), ("ball, noisy", 12_000), (
        "ball, 10,000", 10_000
    ):  # fmt: skip
        assert f"| {name} | {points:,} |" in clouds
    whole = sum(run["pinholes"] + run["see_through"] <= 5e-4 for run in report["clouds"])
    assert f"Of 4 clouds {whole} have at most 0.050 % of both." in clouds
    goal = page.split("## The goal")[1].split("## knot")[0]
    runs = [run for run in report["runs"] if run["noise"] == 0.0 and run["density"] >= 1.0]
    both = [100.0 * (run["pinholes"] + run["see_through"]) for run in runs]
    reached = sum(share <= 0.05 for share in both)
    assert f"| 0 | 16 | {reached}, {max(both):.3f} |" in goal and "PSNR falls" in goal
    assert (folder / "surface.png").read_bytes().startswith(b"\x89PNG")


def test_a_whole_surface_has_no_holes_and_gets_better_with_its_points(outcome):
    folder, _ = outcome
    runs = json.loads((folder / "surface.json").read_text())["runs"]
    for scene in bench_surface.SCENES:
        even = [
            run
            for run in runs
            if (run["scene"], run["spread"], run["noise"], run["normals"])
            == (scene, "even", 0.0, True)
        ]
        assert [run["density"] for run in even] == [0.3, 1.0, 3.0]
        psnr = [run["psnr_db"] for run in even]
        assert psnr == sorted(psnr)
        assert all(run["behind_truth"] < 0.005 for run in even[1:])
        assert even[-1]["hole_fraction"] < 0.01  # of 350 pixels


def test_a_cloud_that_is_missing_says_so(tmp_path):
    result = CliRunner().invoke(
        main, ["bench", "surface", str(tmp_path / "no.ply"), "--out-dir", str(tmp_path)]
    )
    assert result.exit_code == 2
    assert "no.ply: no such file" in result.output
