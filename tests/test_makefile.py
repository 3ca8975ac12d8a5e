"""What `make` says on a machine that lacks a tool."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("missing", ["g++", "perl"])
def test_a_missing_tool_is_named_in_one_line_with_what_to_install(tmp_path, missing):
    for tool in {"g++", "perl", "python3"} - {missing}:
        (tmp_path / tool).symlink_to(shutil.which(tool))
    environment = {name: value for name, value in os.environ.items() if name != "CXX"}
    done = subprocess.run(
        [shutil.which("make"), "-C", str(ROOT), "tools"],
        env={**environment, "PATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    lines = [line for line in done.stderr.splitlines() if line.startswith("splatline:")]
    assert lines == [f"splatline: install what is missing: apt-get install {missing}"]
