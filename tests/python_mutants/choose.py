"""Mutants by cosmic-ray, without those that change nothing that runs."""

import ast
import random
from dataclasses import dataclass

from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

from tests.python_mutants.groups import ROOT, Group

FAMILIES = (
    {"Add", "Sub", "Mul", "Div", "FloorDiv", "Mod", "Pow"},
    {"BitOr", "BitAnd", "BitXor", "LShift", "RShift"},
)
"""Binary operators of one kind. One of the other kind mostly does not compile: any test sees it."""

__all__ = ["Mutant", "change", "choose", "mutate", "places", "same"]


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Parameters
    ----------
    file
        From the repository's folder on.
    operator
        Of cosmic-ray.
    occurrence
        Number of the place that the operator can change.
    line
        Line of the place.
    """

    file: str
    operator: str
    occurrence: int
    line: int


def choose(group: Group, count: int, seed: int) -> list[Mutant]:
    """Return mutants of a group at random: without two alike, or that run as the original does."""
    found = [place for file in group.files() for place in places(file)]
    random.Random(f"{group.name} {seed}").shuffle(found)
    chosen: list[Mutant] = []
    for place in found:
        if len(chosen) == count:
            break
        original = (ROOT / place.file).read_text()
        changed = mutate(original, place)
        if _is_python(changed) and not same(original, changed):
            chosen.append(place)
    return chosen


def mutate(source: str, mutant: Mutant) -> str:
    """Return the text of a file with a mutant's change."""
    changed = mutate_code(source, get_operator(mutant.operator)(), mutant.occurrence)
    assert changed is not None, mutant
    return changed


def change(mutant: Mutant) -> tuple[str, str]:
    """Return the first line that a mutant changes: as it is, and as the mutant has it."""
    original = (ROOT / mutant.file).read_text()
    lines = zip(original.split("\n"), mutate(original, mutant).split("\n"), strict=False)
    before, after = next((one, other) for one, other in lines if one != other)
    return before.strip(), after.strip()


def same(one: str, other: str) -> bool:
    """Return whether two texts run the same: they differ in annotations, or in how they compile."""
    return ast.dump(_Bare().visit(ast.parse(one))) == ast.dump(_Bare().visit(ast.parse(other)))


def places(file: str) -> list[Mutant]:
    """Return every place of a file that an operator can change."""
    tree = get_ast_from_path(ROOT / file)
    found = []
    for name in sorted(operator_names()):
        operator_class = get_operator(name)
        if operator_class.arguments() or not _in_family(name):
            continue
        operator = operator_class()
        positions = [
            start for node in ast_nodes(tree) for start, _ in operator.mutation_positions(node)
        ]
        found += [Mutant(file, name, n, line) for n, (line, _) in enumerate(positions)]
    return found


def _in_family(operator: str) -> bool:
    """Return whether a binary operator is replaced by one of its kind; others are all taken."""
    _, _, pair = operator.partition("ReplaceBinaryOperator_")
    return not pair or any(set(pair.split("_")) <= family for family in FAMILIES)


def _is_python(source: str) -> bool:
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


class _Bare(ast.NodeTransformer):
    """Leaves out annotations, and decorators, which say how numba compiles."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Leave out a function's annotations and decorators."""
        node.returns, node.decorator_list = None, []
        return self.generic_visit(node)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        """Leave out an argument's annotation."""
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        """Leave out a variable's annotation."""
        node.annotation = ast.Constant(None)
        return self.generic_visit(node)
