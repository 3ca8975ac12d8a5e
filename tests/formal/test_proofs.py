"""One planted fault is found, and the proofs fit the hardware; ``make formal`` runs them all."""

import subprocess
import sys
from pathlib import Path

from tests.formal import prove_all
from tests.formal.prove import TOOLS, Outcome, prepare_solver, run
from tests.formal.prove_all import all_proofs, in_order, table
from tests.support.faults import rewrite


def test_abc_finds_a_fault_wherever_its_folder_lies(tmp_path):
    """In /tmp as well, of which YoWASP's tools have one of their own."""
    proof = next(proof for proof in all_proofs() if proof.name == "tiler: pixels, words of 2")
    assert proof.engine.startswith("abc")
    assert run(proof, proof.faults[0], tmp_path).status == "fails"


def test_a_solver_that_never_ran_on_this_machine_says_nothing_but_its_answer(tmp_path, monkeypatch):
    """What it says while it is compiled would be taken for an answer."""
    monkeypatch.setenv("YOWASP_CACHE_DIR", str(tmp_path))
    prepare_solver.cache_clear()
    prepare_solver()
    solver = Path(sys.executable).parent / TOOLS["boolector"]
    asked = subprocess.run([solver, "--version"], capture_output=True, text=True, check=True)
    assert asked.stdout.strip()
    assert asked.stderr == ""


def test_every_proof_has_a_planted_fault():
    assert all(proof.faults for proof in all_proofs())


def test_each_proof_and_each_fault_is_run_once_and_the_quick_ones_first():
    proofs = all_proofs()
    order = [(proof.name, fault and fault.name) for proof, fault in in_order(proofs, faults=True)]
    every = [(p.name, f and f.name) for p in proofs for f in (None, *p.faults)]
    assert len(set(order)) == len(order)
    assert sorted(order, key=str) == sorted(every, key=str)
    quick = {proof.name for proof in proofs if not proof.slow}
    assert {name for name, _ in order[: 2 * len(quick)]} == quick
    wholes = [(proof.name, None) for proof in proofs]
    assert sorted(wholes) == sorted((p.name, f) for p, f in in_order(proofs, faults=False))


def test_every_planted_fault_finds_its_line(monkeypatch):
    """Hardware that is rewritten may lose them."""
    for proof in all_proofs():
        for fault in (None, *proof.faults):
            with monkeypatch.context() as patch:
                for change in (*proof.changes, *([fault] if fault else [])):
                    part, method = change.part, change.method
                    rewrite(patch, part, method, change.pattern, change.replacement)


def test_the_page_lists_every_proof():
    page = Path(__file__).parents[2] / "docs" / "formal.md"
    assert table(all_proofs()) in page.read_text()


def test_a_run_that_breaks_is_told_in_a_line_and_the_others_go_on(monkeypatch, capsys):
    def one_breaks(proof, fault, folder, seconds=None):
        if fault is None and proof.name == "fifo: order, 2 beats":
            raise RuntimeError("sby failed:\nmuch\nis\nin\nits\nlog\nno space left")
        return Outcome("fails" if fault else "holds", 0.0, "")

    monkeypatch.setattr(prove_all, "run", one_breaks)
    monkeypatch.setattr("sys.argv", ["prove_all.py", "fifo"])
    assert prove_all.main() == 1
    said = capsys.readouterr()
    assert "fifo: order, 256 beats           holds" in said.out
    assert said.err == "fifo: order, 2 beats broken: much / is / in / its / log / no space left\n"
