"""The memory of a command, in processes of their own: under a limit, and as it is measured."""

import gzip
import subprocess
import sys

import pytest

from tests.host.large.test_draw_parts import hills, write_las

LIMITED = """
import resource, sys
from pathlib import Path
from splatline.cli.main import main
from splatline.host import pipeline
from splatline.host.files.readers import read_cloud
from splatline.sim import golden
pages = int(Path("/proc/self/statm").read_text().split()[0])
most = pages * resource.getpagesize() + int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_AS, (most, most))
main(prog_name="splatline")
"""

PEAKS = """
from pathlib import Path
from splatline.cli.main import main
for memory in ("501M", "4G"):
    try:
        main(["render", "a.laz", "--size", "64x64", "--memory", memory], prog_name="splatline")
    except SystemExit as stop:
        assert not stop.code
    status = Path("/proc/self/status").read_text()
    print("peak", int(status.split("VmHWM:")[1].split()[0]) << 10)
"""
"""Not ru_maxrss: it begins with what the process had that started this one."""


def splatline(folder, script, *arguments):
    command = [sys.executable, "-c", script, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("room", "told"),
    [
        (40 << 20, "unpacks to more text than fits the memory"),
        (150 << 20, "does not fit the memory"),
    ],
)
def test_packed_text_that_does_not_fit_is_one_line(tmp_path, room, told):
    line = b"1.25 2.5 3.75 0 0 1 10 20 30\n"
    with gzip.open(tmp_path / "a.xyz.gz", "wb", 1) as stream:
        for _ in range(50):
            stream.write(line * (1 << 15))
    ran = splatline(tmp_path, LIMITED, room, "render", "a.xyz.gz", "--size", "32x32")
    assert ran.returncode == 2, ran.stderr
    assert told in ran.stderr.splitlines()[-1]
    assert "Traceback" not in ran.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.xyz.gz"]


def test_a_cloud_in_parts_stays_within_the_memory_that_the_whole_would_break(tmp_path):
    for points in (5_000, 2_000_000):  # the first run may compile, which takes memory of its own
        write_las(tmp_path / "a.laz", *hills(points))
        ran = splatline(tmp_path, PEAKS)
        assert ran.returncode == 0, ran.stderr
    peaks = [int(line.split()[1]) for line in ran.stdout.splitlines() if line.startswith("peak")]
    assert peaks[0] < 501e6 < peaks[1]
