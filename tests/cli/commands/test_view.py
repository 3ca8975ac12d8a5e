"""``splatline view`` as a process of its own."""

import asyncio
import json
import signal
import subprocess
import sys

import pytest
from yarl import URL

from splatline.cli.bench.view.server import running_view
from tests.view.server.pages import client
from tests.view.views import write_ball

PROGRAM = "import sys; from splatline.cli.main import main; sys.exit(main(prog_name='splatline'))"


def start(*arguments):
    """Start the command; return the process, and the address that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "view", *map(str, arguments), "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    return process, process.stdout.readline().strip()


@pytest.mark.parametrize("when", ["drawing", "bad file"])
def test_ctrl_c_ends_it_cleanly_with_a_page_open(tmp_path, when):
    path = write_ball(tmp_path / "ball.csv")
    if when == "bad file":
        path.write_text("x,y,z\n1,2\nno number,1,2\n")
    process, address = start(path, "--port", 0)

    async def use():
        async with client(URL(address)) as page:
            await page.send("resize", width=64, height=48)
            if when == "bad file":
                assert "ball.csv" in (await page.message("error"))["text"]
            else:
                await page.picture(refined=True)
            await page.send("moving", value=True)
            for _ in range(20):
                await page.send("turn", dx=1, dy=0)
            process.send_signal(signal.SIGINT)
            while not page.socket.closed:
                await page.socket.receive(20)
            return page.socket.close_code

    assert address.startswith("http://127.0.0.1:")
    assert asyncio.run(use()) == 1001
    with process:
        assert process.wait(30) == 0
        assert "Ctrl-C" in process.stdout.read()
        assert "Traceback" not in process.stderr.read()


def test_the_bench_s_server_starts_and_ends(tmp_path):
    with running_view([str(write_ball(tmp_path / "ball.csv"))]) as server:
        assert "token=" in server.address
        assert server.processor_seconds() > 0.1


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("missing.ply",), "missing.ply"),
        (("a.what",), "a.what"),
        (("-", "--format", "ply"), "give a file"),
        (("--preset", "lines8"), "view draws the presets"),
        (("--target", "1,2,3"), "go together"),
        (("--scene", "none such"), "no scene named"),
        (("--colour", "intensity", "--map", "none such"), "no colour map"),
        (("--zoom", "2"), "--zoom"),
        (("--memory", "2G"), "--memory"),
    ],
)
def test_a_bad_command_line_is_an_error_of_one_line(run, folder, arguments, text):
    (folder / "a.what").write_text("?")
    result = run("view", "--no-browser", *arguments)
    assert result.exit_code == 2
    lines = result.output.splitlines()
    assert text in lines[-1]
    assert all(line.endswith("...") for line in lines[:-1])  # a scene that is made


def test_several_clouds_are_refused(run, cloud):
    result = run("view", "--no-browser", cloud, cloud)
    assert result.exit_code == 2
    assert "one cloud" in result.output


def test_a_cloud_larger_than_the_memory_is_refused(run, cloud, monkeypatch):
    monkeypatch.setattr("splatline.cli.commands.view.is_large", lambda request: True)
    result = run("view", "--no-browser", cloud)
    assert result.exit_code == 2
    assert "in parts" in result.output


def test_a_port_that_is_taken_is_an_error_of_one_line(run, cloud):
    import socket

    with socket.create_server(("127.0.0.1", 0)) as taken:
        result = run("view", "--no-browser", cloud, "--port", taken.getsockname()[1])
    assert result.exit_code == 2
    assert "cannot be served" in result.output
    assert result.output.strip().count("\n") == 0


def test_without_the_extra_it_says_what_to_install(run, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    for command in (["view"], ["bench", "view"]):
        result = run(*command)
        assert result.exit_code == 2
        assert "aiohttp" in result.output
        assert "[view]" in result.output
        assert result.output.strip().count("\n") == 0


def test_all_options_reach_the_page(run, cloud, monkeypatch):
    seen = []
    monkeypatch.setattr(
        "splatline.view.server.run.serve",
        lambda subject, choices, **options: seen.append((subject, choices, options)),
    )
    result = run(
        "view", cloud, "--up", "z", "--orbit", "-10,5", "--fov", 20, "--target", "1,2,3",
        "--distance", 4, "--preset", "plane", "--quality", "fast", "--samples", 4, "--lights",
        "front", "--background", "#ff8000", "--colour", "height", "--map", "magma", "--fit", "all",
        "--splat-size", 0.5, "--skip", "hidden", "--host", "0.0.0.0", "--port", 81,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    [(subject, choices, options)] = seen
    assert (subject.path, subject.name, subject.up, subject.fit) == (cloud, "ball", "z", "all")
    assert (subject.orbit, subject.fov, subject.splat_size) == ((-10.0, 5.0), 20.0, 0.5)
    assert (subject.target, subject.distance) == ((1.0, 2.0, 3.0), 4.0)
    told = choices.described()
    assert json.loads(json.dumps(told)) == told
    assert (told["preset"], told["quality"], told["samples"]) == ("plane", "fast", 4)
    assert (told["lights"], told["background"]) == ("front", "#ff8000")
    assert told["colour"] == {"by": "height", "map": "magma", "range": None}
    assert "hidden" in choices.settings.skips
    assert {name: options[name] for name in ("host", "port", "browser")} == {
        "host": "0.0.0.0", "port": 81, "browser": True,
    }  # fmt: skip
