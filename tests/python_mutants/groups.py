"""The groups of modules that are mutated, and the tests that must notice."""

from dataclasses import dataclass
from pathlib import Path

__all__ = ["GROUPS", "Group"]

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Group:
    """Modules and their tests.

    Parameters
    ----------
    name
        For people.
    modules
        Patterns of files under the repository.
    tests
        Arguments of pytest, the quickest first.
    """

    name: str
    modules: tuple[str, ...]
    tests: tuple[str, ...]

    def files(self) -> list[str]:
        """Return the modules' files, from the repository's folder on."""
        return sorted(
            file.relative_to(ROOT).as_posix()
            for pattern in self.modules
            for file in ROOT.glob(pattern)
            if file.name != "__init__.py"
        )


GROUPS = (
    Group("golden", ("sim/golden/*.py",), ("tests/sim/golden",)),
    Group(
        "encoder",
        ("host/encode/*.py",),
        ("tests/host/encode", "tests/host/visibility/test_cull.py"),
    ),
    Group(
        "projection",
        ("host/visibility/*.py",),
        ("tests/host/visibility", "tests/host/encode/test_planes.py"),
    ),
    Group("readers", ("host/files/read_*.py",), ("tests/host/files",)),
)
