import os
import subprocess
import sys
import time
from importlib import metadata

import pytest

from splatline.cli.commands import render as render_module
from splatline.cli.main import COMMANDS, NO_MEMORY
from splatline.contract.errors import InputError
from splatline.contract.tool_error import ToolFailure
from splatline.flow.tools import ToolError

HEAVY = ("numpy", "numba", "scipy", "PIL", "matplotlib", "skimage", "amaranth", "cocotb", "rich")


@pytest.mark.parametrize("arguments", [[], ["render"], ["encode"], ["info"], ["synth"]])
def test_help_loads_nothing_heavy(arguments):
    script = (
        "import sys\n"
        "from splatline.cli.main import main\n"
        "try:\n"
        f"    main({[*arguments, '--help']!r})\n"
        "except SystemExit as end:\n"
        "    assert end.code == 0, end.code\n"
        f"print('loaded', [name for name in {HEAVY!r} if name in sys.modules])\n"
    )
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.splitlines()[-1] == "loaded []"


def test_a_command_loads_no_other_command():
    script = (
        "import sys\n"
        "from splatline.cli.main import main\n"
        "try:\n"
        "    main(['render', '--help'])\n"
        "except SystemExit:\n"
        "    pass\n"
        "commands = 'splatline.cli.bench', 'splatline.cli.commands'\n"
        "print('loaded', sorted(name for name in sys.modules if name.startswith(commands)))\n"
    )
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    own = ("", ".render", ".render_tiles")
    loaded = [f"splatline.cli.commands{name}" for name in own]
    assert ran.stdout.splitlines()[-1] == f"loaded {loaded}"


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_shows_examples(run, command):
    result = run(command, "--help")
    assert result.exit_code == 0
    assert "Examples:\n" in result.stdout
    assert f"splatline {command}" in result.stdout.split("Examples:\n")[1]


def test_the_commands_are_those_of_the_manual():
    assert sorted(COMMANDS) == [
        "bench", "board", "encode", "film", "info", "netlist", "play", "pnr", "registers", "render",
        "synth", "verilog", "view",
    ]  # fmt: skip


def test_version_is_the_package_s(run):
    assert run("--version").stdout.strip().endswith(metadata.version("splatline"))


def test_no_command_shows_the_help_and_fails(run):
    result = run()
    assert result.exit_code == 2
    assert "Commands:" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["paint"], "splatline: No such command 'paint' (see splatline --help)\n"),
        (
            ["render", "--size", "huge"],
            "splatline: Invalid value for '--size': 'huge' is not a size; write WIDTHxHEIGHT, like"
            " 512x512 (see splatline render --help)\n",
        ),
        (
            ["render", "--preset", "wide"],
            "splatline: Invalid value for '--preset': preset 'wide' was removed; take swift or"
            " lanes8 (see splatline render --help)\n",
        ),
        (
            ["verilog", "--preset", "deep"],
            "splatline: Invalid value for '--preset': preset 'deep' was removed; take depth12 (see"
            " splatline verilog --help)\n",
        ),
        (["encode"], "splatline: Missing option '-o' / '--output' (see splatline encode --help)\n"),
        (
            ["render", "ball.ply", "--scene", "knot"],
            "splatline: give a CLOUD or a --scene, not both (see splatline render --help)\n",
        ),
    ],
)
def test_a_wrong_command_line_gets_one_line_and_code_2(run, folder, arguments, message):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr == message
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (InputError("scan.ply: is empty"), 2, "splatline: scan.ply: is empty\n"),
        (InputError("two\nlines"), 2, "splatline: two lines\n"),
        (
            PermissionError(13, "Permission denied", "scan.ply"),
            2,
            "splatline: scan.ply: Permission denied\n",
        ),
        (OSError(28, "No space left on device"), 2, "splatline: No space left on device\n"),
        (ToolFailure("it stopped\nthe log"), 1, "splatline: it stopped\nthe log\n"),
        (ToolError("Yosys failed:\nthe log"), 1, "splatline: Yosys failed:\nthe log\n"),
        (KeyboardInterrupt(), 130, "\n"),
        (MemoryError(), 2, f"splatline: {NO_MEMORY}\n"),
        (
            ImportError("libx265.so: failed to map segment from shared object"),
            2,
            f"splatline: {NO_MEMORY}\n",
        ),
    ],
)
def test_errors_are_told_without_a_traceback(run, folder, monkeypatch, error, code, message):
    def fail(*_):
        raise error

    monkeypatch.setattr(render_module, "prepare", fail)
    result = run("render")
    assert (result.exit_code, result.stderr) == (code, message)
    assert not list(folder.iterdir())


@pytest.mark.parametrize("error", [ZeroDivisionError(), ImportError("cannot import name 'x'")])
def test_a_bug_is_not_dressed_up_as_bad_input(run, monkeypatch, error):
    def fail(*_):
        raise error

    monkeypatch.setattr(render_module, "prepare", fail)
    assert isinstance(run("render").exception, type(error))


SLOW_SYNTHESIS = """
import sys, tempfile
from pathlib import Path
from splatline.cli.main import COMMANDS, main
from splatline.flow import tools
from splatline.flow.area import synth

TOOL = "import os, sys, time; os.symlink(str(os.getpid()), sys.argv[1]); time.sleep(300)"

told = sys.argv[1]

def synthesise(config, *, top, progress):
    with tempfile.TemporaryDirectory() as scratch:
        tools._run("Yosys", TOOL, [told], Path(scratch))

synth.synthesise = synthesise
sys.argv = ["splatline", "synth"]
main()
"""


def test_a_run_that_is_terminated_takes_its_tools_and_files_along(tmp_path):
    """The tool here says what its process is, in a link's name, and would take five minutes."""
    scratch, told = tmp_path / "scratch", tmp_path / "process"
    scratch.mkdir()
    environment = {**os.environ, "TMPDIR": str(scratch)}
    command = [sys.executable, "-c", SLOW_SYNTHESIS, str(told)]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, env=environment) as process:
        while process.poll() is None and not told.is_symlink():
            time.sleep(0.02)
        assert list(scratch.iterdir())
        process.terminate()
        assert process.wait(60) == 143
    with pytest.raises(ProcessLookupError):
        os.kill(int(told.readlink().name), 0)
    assert not list(scratch.iterdir())
