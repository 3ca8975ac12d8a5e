"""Each package says what lives in it, what it may import and where to start reading."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ROOMS = ("boards", "cli", "contract", "flow", "host", "plots", "rtl", "sim", "view")
PACKAGES = sorted(
    path.parent.relative_to(ROOT)
    for room in ROOMS
    for path in ROOT.joinpath(room).rglob("__init__.py")
)


def described(package):
    """Return a package's docstring as one line."""
    text = ast.get_docstring(ast.parse((ROOT / package / "__init__.py").read_text()))
    return " ".join((text or "").split())


def may_import(package):
    """Return our packages that a docstring allows; None for all of them."""
    sentence = re.search(r"\bIt imports (.*?)(?:;|\.(?= |$))", described(package))
    assert sentence, "it does not say what it imports"
    if sentence[1] == "all rooms":
        return None
    names = re.findall(r"``([A-Za-z._]+)``", sentence[1])
    return [name for name in names if name.split(".")[0] in ROOMS]


def imported(path):
    """Return the packages and modules of ours that a file imports, wherever in it."""
    package = path.relative_to(ROOT).parent.parts
    for node in ast.walk(ast.parse(path.read_text())):
        if not isinstance(node, ast.ImportFrom):
            continue
        module = node.module or ""
        if node.level:
            above = package[: len(package) - node.level + 1]
            yield ".".join([*above, *module.split(".")]).strip(".")
        elif module.startswith("splatline."):
            yield module.removeprefix("splatline.")
        elif module == "splatline":
            yield from (name.name for name in node.names if name.name in ROOMS)


def within(module, package):
    """Return whether a module is a package or in it."""
    return f"{module}.".startswith(f"{package}.")


def used(package, pattern):
    """Return what is imported from outside, by name, with a file that does so."""
    own = ".".join(package.parts)
    return {
        module: path.name
        for path in (ROOT / package).rglob(pattern)
        for module in imported(path)
        if not within(module, own)
    }


@pytest.mark.parametrize("package", PACKAGES, ids=str)
def test_a_package_imports_what_it_says(package):
    allowed = may_import(package)
    if allowed is None:
        return
    own = {module: path.name for path in (ROOT / package).glob("*.py") for module in imported(path)}
    unsaid = {
        module: file
        for module, file in own.items()
        if not any(within(module, name) for name in [*allowed, ".".join(package.parts)])
    }
    assert not unsaid
    all_of_it = used(package, "*.py")
    # A lazy facade has the names of modules in strings.
    facade = (ROOT / package / "__init__.py").read_text()
    idle = [name for name in allowed if not any(within(m, name) for m in all_of_it)]
    assert not [name for name in idle if f'"{name}.' not in facade]


@pytest.mark.parametrize("package", PACKAGES, ids=str)
def test_a_package_says_where_to_start(package):
    start = re.search(r"\bStart with ``([a-z_0-9]+)``", described(package))
    assert start, described(package)
    folder = ROOT / package
    assert (folder / start[1] / "__init__.py").exists() or list(folder.glob(f"{start[1]}.*"))
