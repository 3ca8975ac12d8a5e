import json

import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.bench.host import measure as bench_host
from splatline.cli.bench.host import peers as bench_peers
from splatline.cli.main import main


def failing(cloud, view, radii):
    raise ModuleNotFoundError("No module named 'peer'", name="peer")


def slow(cloud, view, radii):
    assert len(cloud) == len(radii)
    return 1000.0


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("host")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench_peers, "PEERS", {"absent": failing, "slow": slow})
        arguments = ["--size", "48x40", "--points", "3000", "--repeats", "1"]
        result = CliRunner().invoke(
            main, ["bench", "host", *arguments, "--out-dir", str(folder / "out")]
        )
    assert result.exit_code == 0, result.output
    return folder / "out", result


def test_every_run_has_its_rates_and_what_was_left_out(outcome):
    folder, _ = outcome
    report = json.loads((folder / "host.json").read_text())
    assert len(report["runs"]) == 2 * 2 + 2 * len(bench_host.VIEWS)
    for run in report["runs"]:
        assert set(run["seconds"]) == set(bench_host.STAGES)
        assert run["elements"] + sum(run["culled"].values()) == run["points"]
        assert run["points_per_second"] == pytest.approx(run["points"] / run["host_seconds"])
        assert run["index_bytes_per_point"] <= 64


def test_a_corner_takes_fewer_elements_and_thinning_leaves_points_out(outcome):
    folder, _ = outcome
    runs = json.loads((folder / "host.json").read_text())["runs"]
    large = {run["view"]: run for run in runs[4:] if run["quality"] == "exact"}
    assert large["a corner, 8 times as near"]["culled"]["outside"] > 0
    assert large["from ten times as far, crowds thinned"]["culled"]["crowded"] > 0


def test_peers_are_ratios_and_those_that_are_missing_say_so(outcome):
    folder, result = outcome
    peers = json.loads((folder / "host.json").read_text())["peers"]
    assert [peer["why"] for peer in peers if peer["peer"] == "absent"] == [
        "peer is not installed"
    ] * 2
    assert all(peer["ratio"] > 1 for peer in peers if peer["peer"] == "slow")
    page = (folder / "host.md").read_text()
    assert page in result.stdout
    for head in ("A frame", "The index", "Views of the large cloud", "Other renderers"):
        assert f"## {head}" in page


def test_resampled_clouds_lie_on_the_discs_of_the_first():
    from splatline.host.cloud.resample import resample
    from splatline.host.scenes.scenes import load_scene

    cloud = load_scene("knot").cloud
    radii = np.full(len(cloud), 0.01)
    large, smaller = resample(cloud, radii, 5 * len(cloud) // 4)
    assert len(large) == len(smaller) == 250_000
    assert np.allclose(smaller, 0.01 * np.sqrt(0.8))
    again, _ = resample(cloud, radii, 250_000)
    assert np.array_equal(large.positions, again.positions)
    few, same = resample(cloud, radii, 100)
    assert np.allclose(same, 0.01)
    # Within a disc of some point, and along its plane.
    for place, normal in zip(few.positions, few.normals, strict=True):
        offsets = place - cloud.positions[(cloud.normals == normal).all(axis=1)]
        near = np.linalg.norm(offsets, axis=1) <= 0.006 + 1e-9
        assert (np.abs(offsets[near] @ normal) < 1e-6).any()
