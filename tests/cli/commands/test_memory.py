"""Commands in processes of their own whose memory has a limit."""

import gzip
import subprocess
import sys

import pytest

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


@pytest.mark.parametrize(
    "arguments", [("render", "--size", "32x32"), ("info", "a.xyz"), ("play", "a.frame")]
)
def test_a_limit_that_the_libraries_do_not_fit_is_one_line(tmp_path, arguments):
    """With so little, OpenBLAS waits for memory without end."""
    script = "from splatline.cli.main import main; main(prog_name='splatline')"
    limit = f'ulimit -v {450 << 10}; exec "$0" -c "$1" {" ".join(arguments)}'
    (tmp_path / "a.xyz").write_text("1 2 3\n")
    ran = subprocess.run(
        ["bash", "-c", limit, sys.executable, script],
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert ran.returncode == 2, ran.stderr
    (line,) = ran.stderr.splitlines()
    assert line.startswith("splatline: the limit of address space leaves 4")
    assert line.endswith("raise it, with 'ulimit -v unlimited' for example")
