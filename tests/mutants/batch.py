"""A batch of mutants of one design, and what became of each."""

from collections.abc import Callable
from dataclasses import dataclass

from .context import CONTEXTS, prove_in_context
from .judge import Verdict, judge, judge_engine
from .mutate import Mutant, draw_mutants
from .prove import EQUAL, prove
from .tops import Design

__all__ = ["SHOWN", "Batch", "Judged", "judge_batch"]

SHOWN = (*EQUAL, *CONTEXTS)
"""Answers that say that a mutant is equal."""

STEP = 50
"""Verdicts between two lines of progress."""


@dataclass(frozen=True)
class Batch:
    """Mutants of a design that one seed draws; ``fresh``: once the first frames were written."""

    design: Design
    seed: int
    count: int
    fresh: bool = False


@dataclass(frozen=True)
class Judged:
    """What became of a batch: a verdict for each mutant, and an answer for each that survived."""

    batch: Batch
    mutants: list[Mutant]
    verdicts: list[Verdict]
    answers: dict[Mutant, str]

    @property
    def equal(self) -> list[Mutant]:
        """Mutants that are shown to be equal to the design."""
        return [mutant for mutant, answer in self.answers.items() if answer in SHOWN]

    @property
    def left(self) -> list[Mutant]:
        """Mutants that were neither noticed nor shown to be equal."""
        return [mutant for mutant, answer in self.answers.items() if answer not in SHOWN]


def judge_batch(batch: Batch, told: Callable[[Batch, str], None], *, proofs: bool = True) -> Judged:
    """Judge a batch; ``told`` is called with lines of progress.

    ``proofs``: try to show that survivors are equal.
    """
    mutants = draw_mutants(batch.design, batch.count, batch.seed)
    told(batch, f"{len(mutants)} mutants of seed {batch.seed}")

    def count(done: int) -> None:
        if done and done % STEP == 0:
            told(batch, f"{done} played")

    verdicts = judge(batch.design, mutants, count)
    verdicts = judge_engine(batch.design, mutants, verdicts)
    left = [m for m, verdict in zip(mutants, verdicts, strict=True) if not verdict.noticed]
    told(batch, f"{len(mutants) - len(left)} noticed, {len(left)} survived")
    answers = dict.fromkeys(left, "open")
    if proofs:
        answers = dict(zip(left, prove(batch.design, left), strict=True))
        open_ones = [mutant for mutant, answer in answers.items() if answer not in EQUAL]
        answers |= zip(open_ones, prove_in_context(batch.design, open_ones), strict=True)
        judged = Judged(batch, mutants, verdicts, answers)
        told(
            batch, f"{len(judged.equal)} of them are shown to be equal, {len(judged.left)} are left"
        )
    return Judged(batch, mutants, verdicts, answers)
