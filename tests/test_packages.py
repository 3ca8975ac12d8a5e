"""A wheel has every package: pyproject.toml lists them one by one."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SETTINGS = PROJECT["tool"]["setuptools"]
ROOMS = {folder: name for name, folder in SETTINGS["package-dir"].items()}


def packages_of(folder):
    """Return the packages in a room of the repository, by their names."""
    for file in (ROOT / folder).rglob("__init__.py"):
        inner = file.parent.relative_to(ROOT / folder).parts
        yield ".".join([ROOMS[folder], *inner])


def test_every_folder_with_modules_is_in_the_wheel():
    found = {name for folder in ROOMS for name in packages_of(folder)}
    listed = set(SETTINGS["packages"])
    assert found - listed == set()
    files = listed - found  # folders without modules
    assert files == {"splatline.constraints", "splatline.view.page"}


def test_every_file_of_data_is_in_the_wheel():
    kinds = {".json", ".v", ".c", ".lpf", ".ucf", ".js", ".css", ".html", ".svg"}
    kinds |= {".vlt", ".f"}
    for folder, room in ROOMS.items():
        for file in (ROOT / folder).rglob("*"):
            if file.suffix not in kinds and file.name != "py.typed":
                continue
            name = ".".join([room, *file.parent.relative_to(ROOT / folder).parts])
            patterns = SETTINGS["package-data"].get(name, [])
            assert any(file.match(pattern) for pattern in patterns), file
