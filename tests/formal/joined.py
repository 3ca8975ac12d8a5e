"""Several proofs in one run: to start the tools takes longer than most proofs.

The components stand side by side and share nothing but clock and reset: their promises hold
together if each holds. Planted faults are looked for one at a time.
"""

import re
from dataclasses import replace

from amaranth.hdl import Fragment

from tests.formal.properties import Properties
from tests.support.faults import rewrite

__all__ = ["join"]


class Beside(Properties):
    """Properties side by side: a fragment of each by its name."""

    def __init__(self, parts):
        self.parts = parts

    def describe(self, m):
        """Add the properties."""
        for name, fragment in self.parts.items():
            m.submodules[name] = fragment


def build(proof, patch):
    """Return the fragment of a proof's properties."""
    for change in proof.changes:
        rewrite(patch, change.part, change.method, change.pattern, change.replacement)
    properties = proof.build()
    return Fragment.get(properties, properties.memories)


def join(proofs, monkeypatch):
    """Return one proof of several that agree in depth and engine; a broken one is told by name."""
    first = proofs[0]
    ways = {(proof.depth, proof.endless, proof.engine) for proof in proofs}
    assert len(ways) == 1, "they are not shown in the same way"

    def beside():
        parts = {}
        for proof in proofs:
            with monkeypatch.context() as patch:
                parts[re.sub(r"\W+", "_", proof.name)] = build(proof, patch)
        return Beside(parts)

    return replace(first, name=f"{len(proofs)} proofs", build=beside, faults=(), changes=())
