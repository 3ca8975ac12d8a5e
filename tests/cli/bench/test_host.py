import json

import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.bench.host import first_picture as bench_first
from splatline.cli.bench.host import frames as bench_frames
from splatline.cli.bench.host import measure as bench_host
from splatline.cli.bench.host import peers as bench_peers
from splatline.cli.bench.host.distances import DISTANCES
from splatline.cli.bench.host.first_page import first_pictures
from splatline.cli.bench.host.race import Subject
from splatline.cli.bench.host.race_page import rivals
from splatline.cli.main import main
from splatline.host.cloud.resample import resample
from splatline.host.cloud.spacing import splat_radii
from splatline.host.files.readers import read_cloud
from splatline.host.scenes.scenes import load_scene

PROGRAMS = {
    "absent": ("peer", ""),
    "quick": ("json", "import pathlib, sys; pathlib.Path(sys.argv[2]).write_bytes(b'')"),
    "broken": ("json", "raise OSError('no screen')"),
}


def failing(cloud, view, radii):
    raise ModuleNotFoundError("No module named 'peer'", name="peer")


def slow(cloud, view, radii):
    assert len(cloud) == len(radii)
    return bench_peers.Times(1000.0, 5.0)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("host")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench_peers, "PEERS", {"absent": failing, "slow": slow})
        patch.setattr(bench_first, "PEERS", PROGRAMS)
        patch.setattr(bench_first, "REPEATS", 1)
        patch.setattr(bench_peers, "LEAST_SECONDS", 0.0)
        patch.setattr(bench_first, "kinds", lambda points: (bench_first.Kind(points, True),))
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
        assert set(run["seconds"]) == set(bench_frames.STAGES)
        assert run["elements"] + sum(run["culled"].values()) == run["points"]
        assert run["points_per_second"] == pytest.approx(run["points"] / run["host_seconds"])
        assert run["index_bytes_per_point"] <= 84


def test_a_corner_leaves_out_points(outcome):
    folder, _ = outcome
    runs = json.loads((folder / "host.json").read_text())["runs"]
    large = {run["view"]: run for run in runs[4:] if run["quality"] == "exact"}
    assert large["a corner, 8 times as near"]["culled"]["outside"] > 0


def test_distances_have_times_and_errors(outcome):
    folder, _ = outcome
    runs = json.loads((folder / "host.json").read_text())["distances"]
    assert [run["distance"] for run in runs] == list(DISTANCES)
    assert runs[0]["elements"] > runs[1]["elements"]
    for run in runs:
        assert set(run["errors"]) == {"1", "16"}
        assert run["errors"]["16"]["psnr_db"] > 25.0
    assert "## By distance" in (folder / "host.md").read_text()


def test_peers_are_ratios_and_those_that_are_missing_say_so(outcome):
    folder, result = outcome
    peers = json.loads((folder / "host.json").read_text())["peers"]
    assert [peer["why"] for peer in peers if peer["peer"] == "absent"] == [
        "peer is not installed: pip install '.[peers]'"
    ] * 3
    assert all(peer["ratio"] > 1 for peer in peers if peer["peer"] == "slow")
    page = (folder / "host.md").read_text()
    assert page in result.stdout
    for head in ("A frame", "The index", "Views of the large cloud", "Other renderers"):
        assert f"## {head}" in page


def test_the_time_to_the_first_picture_is_said_by_stage_and_beside_that_of_others(outcome):
    folder, _ = outcome
    (run,) = json.loads((folder / "host.json").read_text())["first_pictures"]
    assert run["points"] == 3000
    assert {"read", "spacing", "golden"} <= set(run["seconds"])
    assert run["start"] > 0.0
    assert run["wall"] == pytest.approx(run["start"] + sum(run["seconds"].values()))
    assert run["peers"]["absent"]["why"] == "peer is not installed: pip install '.[peers]'"
    assert 0.0 < run["peers"]["quick"]["wall"] < run["wall"]
    assert run["peers"]["broken"]["why"] == "OSError: no screen"
    page = (folder / "host.md").read_text()
    assert "## From the command to the picture" in page
    assert "3,000 points, noisy, no normals" in page


def test_files_of_the_first_picture_are_read_as_they_were_written(tmp_path):
    cloud = load_scene("knot").cloud
    for normals in (cloud.normals, None):
        bench_first.write_ply(tmp_path / "a.ply", cloud.positions, normals, cloud.colours)
        read = read_cloud(tmp_path / "a.ply")
        assert np.allclose(read.positions + read.origin, cloud.positions, atol=1e-6)
        assert np.array_equal(read.colours, cloud.colours)
        assert read.two_sided.all() == (normals is None)
        if normals is not None:
            assert np.allclose(read.normals, normals, atol=1e-6)


def test_goals_are_said_for_clouds_that_are_large_enough():
    def page(points, seconds):
        peer = {"cloud": "a", "points": points, "peer": "Embree discs", "seconds": seconds,
                "build_seconds": 0.1, "ours": 0.018, "ratio": seconds / 0.018}  # fmt: skip
        return "\n".join(rivals([peer]))

    assert "goal" not in page(435_999, 0.021)
    assert page(436_000, 0.021).endswith("ours takes 0.857 of Embree's; goal 0.857: met")
    assert "0.947 of Embree's; goal 0.857: missed. Our frame grows" in page(3_999_999, 0.019)
    assert "0.857 of Embree's; goal 0.833: missed. Our frame grows" in page(4_000_000, 0.021)
    assert rivals([]) == []


def test_goals_of_the_first_picture_are_said_of_the_clouds_that_have_one():
    def page(cloud, wall):
        run = {"cloud": cloud, "bytes": 10**7, "wall": wall, "start": 0.5}
        run |= {"seconds": {"read": 0.1, "normals": 0.3}, "peers": {"other": {"wall": 2 * wall}}}
        return "\n".join(first_pictures([run], []))

    kinds = {"4,000,000 points, normals": 3.0, "436,000 points, normals": 1.2,
             "1,000,000 points, noisy, no normals": 2.0}  # fmt: skip
    assert {kind.name for kind in bench_first.kinds(4_000_000)} == {*kinds}
    for name, goal in kinds.items():
        met, missed = page(name, goal), page(name, goal + 0.01)
        assert f"| goal | {goal:.2f}: met |" in met
        assert f"| other | {2 * goal:.2f} (2.00) |" in met
        assert f"| goal | {goal:.2f}: missed |" in missed
        why = f"Of the {goal + 0.01:.2f} s of {name}, start takes 0.50 s and normals 0.30 s."
        assert why in missed
        assert "Of the" not in met
    assert "| goal | - |" in page("3,000 points, normals", 1.0)


def test_times_of_the_first_picture_are_scaled_by_embree_s():
    """Embree takes half as long again as where the goals were set."""
    run = {"cloud": "436,000 points, normals", "bytes": 10**7, "wall": 1.5, "start": 0.5}
    run |= {"seconds": {"read": 1.0}, "peers": {}}
    peer = {"cloud": "a", "peer": "Embree discs", "points": 436_000, "seconds": 0.0315}
    page = "\n".join(first_pictures([run], [peer]))
    assert "| goal | 1.20: missed |\n| scaled | 1.00: met |" in page
    assert "Here it takes 31.5 ms, 1.50 times as long." in page
    for other in ({"points": 1000}, {"peer": "VTK"}, {"seconds": None}):
        assert "scaled" not in "\n".join(first_pictures([run], [peer | other]))


def test_large_clouds_have_the_discs_that_render_draws():
    scene = load_scene("knot")
    subject = Subject(scene.cloud, None, splat_radii(scene.cloud))
    large = bench_host._resampled(subject, 250_000)
    assert len(large.cloud) == 250_000
    assert np.array_equal(large.radii, splat_radii(large.cloud))


def test_resampled_clouds_lie_on_the_discs_of_the_first():
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
