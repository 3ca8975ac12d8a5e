import json
import shutil
import subprocess

import pytest


def test_the_page_is_printed(run, folder):
    result = run("registers")
    assert result.exit_code == 0, result.stderr
    assert "| `0x18` | **ERROR**" in result.stdout
    assert not list(folder.iterdir())


def test_all_three_are_written(run, folder):
    result = run(
        *("registers", "--preset", "rgb24", "--c-header", "splatline.h"),
        *("--json", "map.json", "--markdown", "map.md"),
    )
    assert result.exit_code == 0, result.stderr
    assert result.stdout.endswith("registers of rgb24: splatline.h, map.json, map.md\n")
    assert "#define SPLATLINE_MATERIAL_WORDS 2u" in (folder / "splatline.h").read_text()
    assert json.loads((folder / "map.json").read_text())["preset"] == "rgb24"
    assert "Preset `rgb24`" in (folder / "map.md").read_text()


def test_the_registers_of_an_engine_with_planes_tell_its_code_words(run, folder):
    result = run("registers", "--preset", "plane", "--json", "map.json", "--c-header", "plane.h")
    assert result.exit_code == 0, result.stderr
    assert json.loads((folder / "map.json").read_text())["streams"]["codeword_bytes"] == 16
    assert "#define SPLATLINE_CODEWORD_SLOPE_Y_LSB 74u" in (folder / "plane.h").read_text()


def test_the_driver_is_written_into_a_folder_and_compiles(run, folder):
    result = run("registers", "--preset", "plane", "--c-driver", "new/firmware")
    assert result.exit_code == 0, result.stderr
    names = ["splatline.h", "splatline_driver.c", "splatline_driver.h"]
    assert sorted(path.name for path in (folder / "new/firmware").iterdir()) == names
    compiler = shutil.which("gcc") or shutil.which("cc")
    command = [compiler, "-std=c99", "-Wall", "-Werror", "-c", "splatline_driver.c"]
    subprocess.run(command, cwd=folder / "new/firmware", check=True)


@pytest.mark.parametrize(
    "arguments",
    [
        ("--c-header", "map.c"),
        ("--json", "map.yaml"),
        ("--markdown", "absent/map.md"),
        ("--c-driver", "/dev/null"),
    ],
)
def test_a_file_that_cannot_be_written_is_refused(run, folder, arguments):
    result = run("registers", *arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith("splatline: ")
    assert result.stderr.count("\n") == 1
    assert not list(folder.iterdir())
