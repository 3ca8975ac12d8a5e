"""The standalone bench, run by the command of its own README."""

import re
import subprocess

import pytest
from click.testing import CliRunner

from splatline.cli.main import main
from splatline.sim.cosim import simulator
from splatline.sim.cosim.standalone.write import FILES
from tests.support.faults import fault

needs_icarus = pytest.mark.skipif(not simulator.available("icarus"), reason="no iverilog")


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """Writes the bench of a preset into a folder of its own, once."""
    made = {}

    def write(preset):
        if preset not in made:
            made[preset] = folder = tmp_path_factory.mktemp(preset)
            result = CliRunner().invoke(main, ["verilog", "--preset", preset, "--bench", folder])
            assert result.exit_code == 0, result.output
        return made[preset]

    return write


def command(folder, program):
    """Return the README's command that begins with a program."""
    text = (folder / "README").read_text().replace("\\\n", " ")
    return re.search(rf"^ +({program} .*)$", text, re.MULTILINE)[1]


def run(line, folder):
    """Run a command of the README in the bench's folder."""
    return subprocess.run(
        ["sh", "-c", line], cwd=folder, capture_output=True, text=True, check=False
    )


@needs_icarus
@pytest.mark.parametrize("preset", ["rgb24", "paper"])
def test_the_bench_passes(bench, preset):
    folder = bench(preset)
    assert {path.name for path in folder.iterdir()} >= set(FILES)
    done = run(command(folder, "iverilog"), folder)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^PASS: \d\d\d beats", done.stdout, re.MULTILINE)


@pytest.mark.thorough
@needs_icarus
@pytest.mark.parametrize("preset", ["plane"])
def test_the_bench_of_the_axi_top_passes(tmp_path, preset):
    options = ["verilog", "--preset", preset, "--top", "axi", "--bench", tmp_path]
    assert CliRunner().invoke(main, options).exit_code == 0
    done = run(command(tmp_path, "iverilog"), tmp_path)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^PASS: \d\d\d beats", done.stdout, re.MULTILINE)
    # A packet of code words without its end: the top puts one in, and the picture is another.
    words = tmp_path / "codewords.hex"
    lines = words.read_text().splitlines()
    lines[20] = "1" + lines[20][1:]
    words.write_text("\n".join(lines) + "\n")
    done = run("vvp bench.vvp", tmp_path)
    assert done.returncode == 1, done.stdout
    assert "FAIL: " in done.stdout


@needs_icarus
@pytest.mark.parametrize(
    ("planted", "says"),
    [
        (fault("splatline_paper.colour", "sum_red", "products_red"), "an unlike beat"),
        (fault("splatline_paper.sequencer", "control", "1'h0"), "the engine is stuck"),
    ],
    ids=["a colour", "no control words"],
)
def test_a_planted_fault_fails(bench, planted, says):
    folder = bench("paper")
    verilog = folder / "splatline_paper.v"
    whole = verilog.read_text()
    verilog.write_text(planted(whole))
    try:
        done = run(command(folder, "iverilog"), folder)
    finally:
        verilog.write_text(whole)
    assert done.returncode == 1, done.stdout
    (line,) = re.findall(r"^FAIL: .*$", done.stdout, re.MULTILINE)
    assert says in line
    assert "PASS" not in done.stdout


def test_no_icarus_is_needed_to_write(bench):
    folder = bench("paper")
    sizes = dict(
        re.findall(r"^`define (\w+) (\w+)$", (folder / "bench_sizes.vh").read_text(), re.M)
    )
    for name, entry in {
        "tables": 2 * int(sizes["TABLES_OF_FRAME"]),
        "codewords": int(sizes["CODEWORDS"]),
        "initial": int(sizes["INITIALS"]),
        "raster": int(sizes["BEATS"]),
    }.items():
        assert len((folder / f"{name}.hex").read_text().splitlines()) == entry


@pytest.mark.parametrize(
    "options", ["--top pins", "--engines 2", "--preset paper-rom --readmemh rom"]
)
def test_a_bench_that_there_is_not_is_refused(tmp_path, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["verilog", *options.split(), "--bench", "bench"])
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
