"""The tables of the mutants: a summary for the terminal, and the page of the manual."""

from collections import Counter
from collections.abc import Iterable, Sequence

from .batch import SHOWN, Judged
from .context import CONTEXTS
from .keep import versions
from .prove import LEVELS

__all__ = ["page", "score", "share", "summary"]

HEAD = """\
# Mutants

How well would the benches notice a fault that nobody thought of? A mutant is the generated Verilog
with a bit at a cell changed by Yosys: inverted, constant, or inverted by another bit of the port.
Mutants are spread over all modules, cells and kinds. Clocks and contents of memories stay.

Made by `make mutants`, with {tools}.

The **fast bench** plays small frames of every kind to each mutant. It compares every beat with the
golden renderer, every cycle with the rules of the streams, and the cycles of a frame with the cycle
model. Streams wait for each other, so that an engine that waits too long hangs. Some frames have
bounds on their cycles. On AXI it compares every answer of the bus as well. A survivor in the
engine of an AXI top is played to that engine **alone**, with the frames of an engine.

A mutant that nothing notices **survives**. Then ABC tries to show that it is **equal** to the
design: {levels}. A module gets any inputs in these proofs.

What is left is compared where the design uses it: {contexts}.
For the first, induction over one cycle compares all but the clearing. The clearing is simulated
from an unknown state with unknown inputs, and writes every word in all of its cycles. A row of
lanes is compared alone, with the requests that the window was seen to make while it clears.

The **score** is the share of the noticed among those that are not shown to be equal.

What a seed shows that nobody has seen before: of the 200 mutants of seed 271128, 186 were noticed
when they were first drawn, 9 were shown to be equal, and 5 were left: a score of 97.4 %. Frames
that were then written notice 3 of the 5. A proof, and more time for another, show 2 to be equal.
"""


def share(noticed: int, mutants: int, equal: int) -> str:
    """Return the score in per cent."""
    real = mutants - equal
    return f"{100 * noticed / real:.1f} %" if real else "-"


def _alone(judged: Iterable[Judged]) -> int:
    """Return how many mutants were noticed by the frames of an engine alone."""
    return sum(verdict.alone for one in judged for verdict in one.verdicts)


def _counts(judged: Iterable[Judged]) -> tuple[int, int, int, int]:
    """Return the numbers of mutants, of the noticed, the equal and the others."""
    each = list(judged)
    mutants = sum(len(one.mutants) for one in each)
    noticed = sum(verdict.noticed for one in each for verdict in one.verdicts)
    return mutants, noticed, sum(len(one.equal) for one in each), sum(len(one.left) for one in each)


def score(judged: Sequence[Judged]) -> float:
    """Return the share of the noticed among the mutants that are not shown to be equal."""
    mutants, noticed, equal, _ = _counts(judged)
    return noticed / max(1, mutants - equal)


def summary(judged: Sequence[Judged]) -> str:
    """Return a line for each batch and one for all."""
    lines = []
    for name, part in [*((one.batch.design.name, [one]) for one in judged), ("all", judged)]:
        mutants, noticed, equal, left = _counts(part)
        seed = f"seed {part[0].batch.seed}" if name != "all" else ""
        lines.append(
            f"{name:10} {seed:14} {mutants:5} mutants, {noticed:5} noticed, {equal:4} equal,"
            f" {left:3} left: {share(noticed, mutants, equal)}"
        )
    lines += [f"left: {one.batch.design.name} {mutant}" for one in judged for mutant in one.left]
    return "\n".join(lines)


def page(judged: Sequence[Judged]) -> str:
    """Return the page of the manual."""
    tools = ", ".join(f"{name} {version}" for name, version in versions().items())
    levels, contexts = ("; ".join(each.values()) for each in (LEVELS, CONTEXTS))
    designs = dict.fromkeys(one.batch.design for one in judged)
    seeds = sorted({(one.batch.fresh, one.batch.seed) for one in judged})
    parts = [HEAD.format(tools=tools, levels=levels, contexts=contexts), "## By design\n"]
    rows = [
        (design.name, [one for one in judged if one.batch.design == design]) for design in designs
    ]
    rows += [
        (f"of seed {seed}" + (", the last one" if fresh else ""),
         [one for one in judged if one.batch.seed == seed])
        for fresh, seed in seeds
    ]  # fmt: skip
    parts.append(_table("design", [*rows, ("**all**", judged)]))
    for design in designs:
        own = [one for one in judged if one.batch.design == design]
        names = sorted({mutant.part for one in own for mutant in one.mutants})
        parts += [
            f"\n## {design.name}\n",
            _table("module", [(n, [_of(o, n) for o in own]) for n in names]),
        ]
    parts += [
        "\n## What notices first\n",
        _kinds(judged),
        "\n## Neither noticed nor shown to be equal\n",
    ]
    left = [f"- `{one.batch.design.name}: {mutant}`" for one in judged for mutant in one.left]
    parts.append("\n".join(left) if left else "None.")
    return "\n".join(parts) + "\n"


def _of(judged: Judged, part: str) -> Judged:
    """Return what became of the mutants of one module."""
    chosen = [n for n, mutant in enumerate(judged.mutants) if mutant.part == part]
    return Judged(
        judged.batch,
        [judged.mutants[n] for n in chosen],
        [judged.verdicts[n] for n in chosen],
        {mutant: answer for mutant, answer in judged.answers.items() if mutant.part == part},
    )


def _table(title: str, rows: Iterable[tuple[str, Sequence[Judged]]]) -> str:
    """Return a table with a row for each name."""
    lines = [
        f"| {title} | mutants | noticed | of them alone | equal | left | score |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for name, part in rows:
        mutants, noticed, equal, left = _counts(part)
        score = share(noticed, mutants, equal)
        row = [name, mutants, noticed, _alone(part), equal, left, score]
        lines.append("| " + " | ".join(map(str, row)) + " |")
    return "\n".join(lines)


def _kinds(judged: Iterable[Judged]) -> str:
    """Return a table of the kinds of frames, and one of what was wrong."""
    verdicts = [verdict for one in judged for verdict in one.verdicts if verdict.noticed]
    lines = []
    for title, counted in (
        ("frames", Counter(verdict.kind for verdict in verdicts)),
        ("what is wrong", Counter(verdict.reason for verdict in verdicts)),
    ):
        lines += [f"| {title} | mutants |", "|---|---:|"]
        lines += [f"| {name} | {count} |" for name, count in counted.most_common()] + [""]
    answers = Counter(
        answer for one in judged for answer in one.answers.values() if answer in SHOWN
    )
    lines += ["| why a survivor is equal | mutants |", "|---|---:|"]
    titles = LEVELS | CONTEXTS
    lines += [f"| {titles[name]} | {count} |" for name, count in answers.most_common()]
    return "\n".join(lines)
