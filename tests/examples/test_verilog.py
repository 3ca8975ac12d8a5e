import re
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from splatline.cli.main import main
from splatline.sim.cosim import simulator

FOLDER = Path(__file__).parents[2] / "examples" / "verilog"
BLOCK = re.compile(r"^ {4}(\S.*)$", re.MULTILINE)


@pytest.mark.skipif(not simulator.available("icarus"), reason="no iverilog")
def test_the_commands_of_the_readme_draw_the_same_with_two_engines(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for file in FOLDER.glob("*.v"):
        (tmp_path / file.name).write_text(file.read_text())
    one, *writes, build, run = BLOCK.findall((FOLDER / "README.md").read_text())
    assert one == "splatline verilog --preset rgb24 --bench bench"
    for command in writes:
        assert CliRunner().invoke(main, command.split()[1:]).exit_code == 0
    subprocess.run(build.split(), check=True)
    done = subprocess.run(run.split(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^PASS: \d+ beats of paper, \d+ of rgb24$", done.stdout, re.MULTILINE)

    beats = tmp_path / "rgb24" / "raster.hex"
    whole = beats.read_text()
    beats.write_text(whole.replace(whole[:2], "3f", 1))
    done = subprocess.run(run.split(), capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "FAIL: rgb24, beat 0" in done.stdout.replace("   ", "")
