import json

import laspy
import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.bench.large.make_scan import OFFSETS, make_scan
from splatline.cli.main import main


def test_a_scan_covers_the_terrain_evenly_in_map_coordinates(tmp_path):
    told = []
    make_scan(tmp_path / "a.laz", 50_000, progress=told.append)
    scan = laspy.read(tmp_path / "a.laz")
    assert len(scan.x) == 50_000
    assert told[-1] == 1.0
    extent = np.ptp(scan.xyz, axis=0)
    assert 29_000 < extent[0] < 31_000 and 31_000 < extent[1] < 32_500 and extent[2] > 2000
    assert abs(scan.x.min() - OFFSETS[0]) < 200
    counts, _, _ = np.histogram2d(scan.x, scan.y, bins=8)
    assert counts.min() > 0.5 * counts.mean()
    assert np.ptp(scan.red) > 30_000
    make_scan(tmp_path / "b.laz", 50_000)
    assert (tmp_path / "a.laz").read_bytes() == (tmp_path / "b.laz").read_bytes()


@pytest.mark.thorough
def test_every_way_is_measured(tmp_path):
    pytest.importorskip("distributed", reason="needs the extra dask")
    arguments = ["--points=30000", "--size=64x64", "--preset=rgb24", "--memory=501M"]
    result = CliRunner().invoke(
        main, ["bench", "large", *arguments, "--out-dir", str(tmp_path / "out")]
    )
    assert result.exit_code == 0, result.output
    report = json.loads((tmp_path / "out" / "large.json").read_text())
    assert report["same"]
    assert report["points"] == 30_000
    for way in ("decompress", "read", "render", "dask"):
        assert report[way]["seconds"] > 0 and report[way]["peak"] > 1 << 20
    page = (tmp_path / "out" / "large.md").read_text()
    assert "Dask's picture is the same" in page
    assert "COPC" not in page


def test_a_scan_that_cannot_be_read_is_one_line(tmp_path):
    result = CliRunner().invoke(
        main, ["bench", "large", str(tmp_path / "none.laz"), "--out-dir", str(tmp_path)]
    )
    assert result.exit_code != 0
    assert "none.laz" in result.output
