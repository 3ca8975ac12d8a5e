"""The quick proofs hold, and each finds its planted faults; ``make formal`` runs the others too."""

from pathlib import Path

import pytest
from prove import run
from prove_all import all_proofs, table

QUICK = [proof for proof in all_proofs() if not proof.slow]


@pytest.mark.parametrize("proof", QUICK, ids=lambda proof: proof.name)
def test_a_proof_holds(proof):
    outcome = run(proof)
    assert outcome.status == "holds", outcome.log


@pytest.mark.parametrize(
    ("proof", "fault"),
    [
        pytest.param(proof, fault, id=f"{proof.name}: {fault.name}")
        for proof in QUICK
        for fault in proof.faults
    ],
)
def test_a_planted_fault_is_found(proof, fault):
    outcome = run(proof, fault)
    assert outcome.status == "fails", outcome.log


def test_every_proof_has_a_planted_fault():
    assert all(proof.faults for proof in all_proofs())


def test_the_page_lists_every_proof():
    page = Path(__file__).parents[2] / "docs" / "formal.md"
    assert table(all_proofs()) in page.read_text()
