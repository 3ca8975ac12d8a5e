"""A plugin of pytest: numba's functions tell which of their statements run.

Each statement of a function that is compiled gets a call before it, which sets a byte. So what is
seen is the compiled code, with its own numbers, loops and threads. ``$SPLATLINE_COUNTS`` names the
folder: a process leaves ``*.lines`` there, with ``file line reached`` a line.
"""

import ast
import atexit
import inspect
import os
import textwrap
import uuid
from pathlib import Path

import numba
import numpy as np
from llvmlite import ir
from numba.core.caching import NullCache
from numba.extending import intrinsic

from splatline.host import compiled_cache

ROOT = Path(__file__).parents[2]
ROOMS = ("host", "sim", "view", "cli")

MOST = 1 << 16
"""Statements."""

_reached = np.zeros(MOST, np.uint8)
_places: list[tuple[str, int]] = []
_njit = numba.njit
_checked = compiled_cache.CheckedCache


@intrinsic
def _statement_ran(_, number):
    """Set the byte of a statement."""

    def code(context, builder, signature, arguments):
        whole, byte = ir.IntType(64), ir.IntType(8)
        address = builder.add(arguments[0], ir.Constant(whole, _reached.ctypes.data))
        builder.store(byte(1), builder.inttoptr(address, byte.as_pointer()))
        return context.get_dummy_value()

    return numba.void(numba.int64), code


class _Counted(ast.NodeTransformer):
    """Puts a call before each statement but docstrings."""

    def __init__(self, file: str) -> None:
        self._file = file

    def generic_visit(self, node):
        """Change the lists of statements of a node."""
        super().generic_visit(node)
        for name in ("body", "orelse"):
            statements = getattr(node, name, None)
            if isinstance(statements, list) and isinstance(node, ast.stmt):
                changed = []
                for one in statements:
                    if not (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant)):
                        changed.append(self._call(one))
                    changed.append(one)
                setattr(node, name, changed)
        return node

    def _call(self, statement: ast.stmt) -> ast.stmt:
        _places.append((self._file, statement.lineno))
        call = ast.parse(f"_statement_ran({len(_places) - 1})").body[0]
        return ast.fix_missing_locations(ast.copy_location(call, statement))


def counted(function):
    """Return a function that tells which of its statements run; others' functions as they are."""
    if not _is_ours(function):
        return function
    source, first = inspect.getsourcelines(function)
    tree = ast.parse(textwrap.dedent("".join(source)))
    ast.increment_lineno(tree, first - 1)
    tree.body[0].decorator_list = []
    file = inspect.getsourcefile(function)
    code = compile(_Counted(file).visit(tree), file, "exec")
    function.__globals__["_statement_ran"] = _statement_ran
    made = {}
    exec(code, function.__globals__, made)  # what the module itself would define
    return made[function.__name__]


def njit(*arguments, **options):
    """Compile as numba does a function that tells its statements."""
    if arguments and callable(arguments[0]):
        return _njit(counted(arguments[0]), *arguments[1:], **options)
    return lambda function: _njit(*arguments, **options)(counted(function))


def _is_ours(function) -> bool:
    """Return whether a function is of a room; the tests compile others, to damage their files."""
    file = Path(inspect.getsourcefile(function))
    return file.is_relative_to(ROOT) and file.relative_to(ROOT).parts[0] in ROOMS


def _cache(function):
    """Return the cache of a function; none for those that tell, as they have addresses in them."""
    return NullCache() if _is_ours(function) else _checked(function)


def _write(path: Path) -> None:
    lines = [f"{file} {line} {_reached[n]}\n" for n, (file, line) in enumerate(_places)]
    path.write_text("".join(lines))


_folder = Path(os.environ["SPLATLINE_COUNTS"]).resolve()
_folder.mkdir(parents=True, exist_ok=True)
atexit.register(_write, _folder / f"{uuid.uuid4().hex}.lines")
# Before any compiled function of Splatline is imported, which conftest.py does.
numba.njit = njit
compiled_cache.CheckedCache = _cache
