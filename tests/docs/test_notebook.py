"""The notebook of the manual runs, and shows what is stored in it."""

import re

import nbformat
import pytest

from docs.notebook.make_tour import TOUR, run, tour


def outputs(notebook):
    """Return what each cell shows: texts, and kinds of pictures."""
    shown = []
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            data = output.get("data", {"text/plain": output.get("text", "")})
            shown.append((output.output_type, data["text/plain"], sorted(data)))
    return shown


@pytest.fixture(scope="module")
def stored():
    return nbformat.read(TOUR, as_version=4)


def test_the_stored_notebook_is_small_and_has_the_cells_of_its_script(stored):
    nbformat.validate(stored)
    assert TOUR.stat().st_size < 300_000
    assert [cell.source for cell in stored.cells] == [cell.source for cell in tour().cells]


def test_the_notebook_runs_and_shows_what_is_stored(stored):
    shown = outputs(run(tour()))
    assert shown == outputs(stored)
    kinds = [kind for _, _, data in shown for kind in data]
    assert "application/vnd.jupyter.widget-view+json" in kinds
    assert kinds.count("image/png") == 2
    assert shown[-1][1] == "True"
    table = next(text for _, text, _ in shown if text.startswith("preset"))
    assert len(re.findall(r"^(?:paper|rgb24|swift) ", table, re.MULTILINE)) == 6
