import dataclasses
import json

import numba
import pytest
from click.testing import CliRunner

from splatline.cli.main import main
from splatline.sim.stress import themes as all_themes
from splatline.sim.stress.themes import themes


def run(folder, chosen):
    """Run the command on some themes alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(all_themes, "themes", lambda: chosen)
        patch.setattr(numba, "set_num_threads", lambda number: None)  # other tests have more
        return CliRunner().invoke(main, ["bench", "stability", "--out-dir", str(folder)])


@pytest.fixture(scope="module")
def few():
    """Two themes with two cases each, and with one of their qualities."""
    whole = themes()
    return {
        name: dataclasses.replace(whole[name], cases=whole[name].cases[:2], qualities=("exact",))
        for name in ("transforms", "sizes")
    }


@pytest.fixture(scope="module")
def right(tmp_path_factory, few):
    folder = tmp_path_factory.mktemp("right")
    return folder, run(folder, few)


def test_cases_that_are_as_expected_end_with_0(right, few):
    folder, result = right
    assert result.exit_code == 0, result.output
    assert "4 of 4 cases as expected" in result.stdout
    for name in few:
        assert f"{few[name].title} ..." in result.stderr
    assert {path.name for path in folder.iterdir()} == {"stability.json", "stability.md"}


def test_each_case_has_a_row_and_a_line_of_its_own(right, few):
    folder, _ = right
    names = [case.name for theme in few.values() for case in theme.cases]
    text = (folder / "stability.json").read_text()
    found = [case for theme in json.loads(text)["themes"] for case in theme["cases"]]
    assert [case["case"] for case in found] == names
    assert all(set(case["qualities"]) == {"exact"} for case in found)
    lines = [line for line in text.splitlines() if '"case": ' in line]
    assert [json.loads(line.rstrip(","))["case"] for line in lines] == names
    page = (folder / "stability.md").read_text()
    rows = [line for line in page.splitlines() if line.startswith("| ") and line.endswith("yes |")]
    assert [row.split(" | ")[0].removeprefix("| ") for row in rows] == names
    assert "Not as expected" not in page
    for theme in few.values():
        assert f"\n## {theme.title}\n\n{theme.expected}\n" in page


def test_a_case_that_is_not_as_expected_is_told_and_ends_with_1(tmp_path, few):
    """A cloud that should give the picture of another one."""
    theme = few["transforms"]
    other = dataclasses.replace(
        theme.cases[0], name="another cloud", make=few["sizes"].cases[0].make
    )
    wrong = dataclasses.replace(theme, cases=(theme.cases[0], other))
    result = run(tmp_path / "new", {"transforms": wrong})
    assert result.exit_code == 1
    assert "1 of 2 cases as expected" in result.stdout
    page = (tmp_path / "new" / "stability.md").read_text()
    assert "Not as expected:\n\n- another cloud, `exact`: " in page
    (row,) = (line for line in page.splitlines() if line.startswith("| another cloud |"))
    assert row.endswith("| **no** |")


def test_a_folder_that_is_a_file_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    result = run(tmp_path / "file", {})
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1].startswith("splatline: ")
    assert (tmp_path / "file").read_text() == ""
