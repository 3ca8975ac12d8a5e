"""Files in the root that other programs read."""

import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]


def test_the_citation_is_of_this_version_and_names_the_paper():
    """``cffconvert --validate`` found nothing to complain of."""
    told = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert {"cff-version", "message", "title", "authors"} <= set(told)
    assert told["version"] == project["version"]
    assert told["license"] == project["license"]
    (paper,) = told["references"]
    assert paper["title"] == "Point Cloud Rendering in FPGA"
    assert [author["family-names"] for author in paper["authors"]] == ["Zemčík", "Maršík", "Herout"]


def test_hooks_run_what_lint_runs():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
    (local,) = hooks["repos"]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    entries = [hook["entry"] for hook in local["hooks"]]
    assert [entry.split()[:2] for entry in entries[:2]] == [
        [".venv/bin/ruff", "check"], [".venv/bin/ruff", "format"],
    ]  # fmt: skip
    assert entries[2] == "make types"
    for command in ("$(VENV)/bin/ruff check", "$(VENV)/bin/ruff format", "$(MAKE)"):
        assert command in makefile.split("\nlint:")[1].split("\n\n")[0]
    assert "\ntypes:" in makefile
