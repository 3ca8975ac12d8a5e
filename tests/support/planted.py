"""Rewritten lines of several components in one build: a number selects one when it runs."""

import ast
import contextlib
import copy
import inspect
import json
import re
import tempfile
import textwrap
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from amaranth.hdl import Mux

from splatline.flow.verilog import convert
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.simulator import SimulationError
from tests.support import bench_config
from tests.support.faults import replace_method

__all__ = ["build", "find_wrong", "plant", "play_with"]

VALUES = ("eq", "If", "Elif")
"""Calls whose arguments are values of the hardware, whatever their width."""

NEW_REGISTER = "m = Module(); self.planted = planted = Signal(8, reset_less=True)"
NEW_REGISTER += "; m.d.sync += planted.eq(planted)"
"""A register that nothing writes, so that it stays in the Verilog."""


PLUSARG = 'initial if (!$value$plusargs("fault=%d", planted)) planted = 0;'
"""What sets a register to the fault of a run."""


def build(make, faults, edit=lambda text: text, **options):
    """Build a component, which ``make`` returns, with faults; it is called ``dut``.

    Its port ``fault`` selects one. ``edit`` changes the Verilog besides; ``options`` are those of
    ``simulator.build``.
    """
    with pytest.MonkeyPatch.context() as patch:
        planted = plant(patch, faults)
        text = edit(planted(convert(make(), "dut")))
    text = text.replace(PLUSARG, "").replace("planted <= planted;", "planted <= dut.fault;")
    text, count = re.subn(r"(?m)^(module dut\()([^;]*;)", r"\1fault, \2 input [7:0] fault;", text)
    assert count == 1
    return simulator.build({"dut.v": text}, "dut", **options)


def find_wrong(config, built, bench, faults, *, whole=True):
    """Run a bench on a build with faults, in one simulator, and return what comes out wrong.

    First all of its tests run without a fault, then each fault with the test that must notice it,
    and then these tests once more without, which shows that no fault outlasts its own test.

    Parameters
    ----------
    faults
        By name: the test and the fault's number.
    whole
        Whether tests run first that notice no fault; they may not suit every engine.

    Returns
    -------
    list of str
        The faults that are not noticed, and the tests that fail without one.
    """
    tests = dict.fromkeys(test for test, _ in faults.values())
    assert [test for test in tests if not hasattr(bench, test)] == []
    runs = [
        *((name, *fault) for name, fault in faults.items()),
        *((test, test, 0) for test in tests),
    ]
    modules = f"{bench.__name__}," * whole + f"{__package__}.fault_bench"
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "faults.json").write_text(json.dumps([bench.__name__, runs]))
        with contextlib.suppress(SimulationError):  # as tests must fail
            bench_config.run_built(config, built, modules, folder)
        cases = list(ElementTree.parse(folder / "results.xml").iter("testcase"))
    failed = {
        case.get("name") for case in cases if {"failure", "error"} & {part.tag for part in case}
    }
    names = {case.get("name") for case in cases}
    assert names >= {name for name, *_ in runs}
    return sorted(failed ^ faults.keys())


def play_with(number, jobs, built, play=frames.play):
    """Play jobs on a build of the player around hardware with faults, with one of them."""
    run = simulator.run

    def with_fault(*args, plusargs=(), **rest):
        run(*args, plusargs=[*plusargs, f"+fault={number}"], **rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator, "run", with_fault)
        return play(jobs, built=built)


def plant(monkeypatch, faults):
    """Plant faults, each the arguments of :func:`faults.rewrite`; return an edit of the Verilog.

    ``+fault=N`` selects the Nth, and ``+fault=0`` none. The value that a fault changes, the
    argument of ``eq`` or ``If``, or what a name stands for or a method returns, is chosen between
    the two: so a line that is rewritten otherwise cannot be planted here.
    """
    trees, broken = {}, {}
    for number, (part, method, pattern, replacement) in enumerate(faults, 1):
        source = textwrap.dedent(inspect.getsource(getattr(part, method)))
        changed, count = re.subn(pattern, replacement, source)
        assert count == 1, f"{part.__name__}.{method} has {count} places to break"
        tree = trees.setdefault((part, method), ast.parse(source))
        other = ast.parse(changed)
        broken.setdefault((part, method), []).append((number, other, _changed_value(tree, other)))
    for part in {part for part, _ in trees}:
        if (part, "elaborate") not in trees:
            source = textwrap.dedent(inspect.getsource(part.elaborate))
            trees[part, "elaborate"] = ast.parse(source)
    for (part, method), tree in trees.items():
        _choose(tree, broken.get((part, method), []))
        source = ast.unparse(tree)
        if method == "elaborate":
            assert "m = Module()" in source
            source = source.replace("m = Module()", NEW_REGISTER, 1)
        replace_method(monkeypatch, part, method, source, "faults", Mux=Mux)

    def edit(text):
        text, count = re.subn(
            r"reg \[7:0\] planted = 8'h00;", lambda found: f"{found[0]} {PLUSARG}", text
        )
        assert count >= len({part for part, _ in trees})
        return text

    return edit


def _changed_value(tree, other):
    """Return the way to the smallest value that differs, as fields and places in lists."""
    way, found = (), None
    one, two, parent = tree, other, None
    while True:
        if isinstance(one, ast.expr) and _is_value(parent, one):
            found = way
        steps = [] if type(one) is not type(two) else list(_differences(one, two))
        if len(steps) != 1:
            assert found is not None, ast.unparse(one)
            return found
        parent = one
        for step in steps:
            way, one, two = (*way, step), _child(one, step), _child(two, step)


def _is_value(parent, node):
    """Whether a node is an argument of one of ``VALUES``, is given a name or is returned."""
    if isinstance(parent, ast.Assign | ast.Return):
        return node is parent.value
    return (
        isinstance(parent, ast.Call)
        and isinstance(parent.func, ast.Attribute)
        and parent.func.attr in VALUES
        and node in parent.args
    )


def _differences(one, two):
    """Yield the fields of two nodes that differ; more than one where lists are not as long."""
    for name in one._fields:
        left, right = getattr(one, name), getattr(two, name)
        if isinstance(left, list) and isinstance(right, list) and len(left) == len(right):
            for n, pair in enumerate(zip(left, right, strict=True)):
                if _text(pair[0]) != _text(pair[1]):
                    yield name, n
        elif _text(left) != _text(right):
            if not isinstance(left, ast.AST) or not isinstance(right, ast.AST):
                yield from ((name, None), (name, None))
            yield name, None


def _text(node):
    return ast.dump(node) if isinstance(node, ast.AST) else repr(node)


def _child(node, step):
    name, n = step
    return getattr(node, name) if n is None else getattr(node, name)[n]


def _at(tree, way):
    for step in way:
        tree = _child(tree, step)
    return tree


def _choose(tree, broken):
    """Put choices between a tree's values and those of the broken ones in their place."""
    ways = {way for *_, way in broken}
    outer = {way: min((w for w in ways if w == way[: len(w)]), key=len) for way in ways}
    for way in set(outer.values()):
        value = _at(tree, way)
        for number, other, own in broken:
            if outer[own] == way:
                instead = copy.deepcopy(_at(other, way))
                chosen = ast.parse(f"Mux(self.planted == {number}, 0, 0)", mode="eval").body
                chosen.args[1:] = [instead, value]
                value = chosen
        parent, (name, n) = _at(tree, way[:-1]), way[-1]
        if n is None:
            setattr(parent, name, value)
        else:
            getattr(parent, name)[n] = value
