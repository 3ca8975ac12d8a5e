"""A campaign on an engine with planted faults, of which an upset of a register selects one."""

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.sim.cosim.faults.campaign import Campaign, kinds_of
from splatline.sim.cosim.faults.records import WORD, Batch, Phase
from splatline.sim.cosim.faults.tally import Tally
from tests.support.planted import PLUSARG, plant

__all__ = ["COUNTS", "PlantedCampaign"]

COUNTS = {"stalls": 80, "resets": 60, "table writes": 240, "counters": 12}
"""Trials of a sample by kind; of any other kind there are 60."""


class PlantedCampaign:
    """A campaign of ``paper`` with faults, each the arguments of ``tests.support.faults.rewrite``.

    Faults are numbered from 1; 0 is none.
    """

    def __init__(self, faults, top="engine"):
        with pytest.MonkeyPatch.context() as patch:
            planted = plant(patch, faults)
            edit = lambda text: planted(text).replace(PLUSARG, "")  # noqa: E731
            self.campaign = Campaign(PAPER, 3, top=top, edit=edit)
        self.chosen = 0

    def choose(self, number):
        """Select a fault, by upsets of the registers that select it."""
        changed = self.chosen ^ number
        self.chosen = number
        nothing = np.zeros(0, WORD)
        phases = [
            Phase(nothing, frames=0, upset_at=0, upset=(place, bit, 0))
            for place, register in enumerate(self.campaign.model.registers())
            if register.name == "planted"
            for bit in range(register.bits)
            if changed >> bit & 1
        ]
        if phases:
            self.campaign.model.play(Batch(phases, self.campaign.limbs))

    def sample(self, number, kinds=None, *, to_the_end=False):
        """Return the tally of trials of each kind, with a fault; up to a wrong one."""
        self.choose(number)
        tally = Tally()
        for kind in kinds or [kind for kind in kinds_of(self.campaign.top) if kind != "upsets"]:
            total = COUNTS.get(kind, 60)
            tally.add(self.campaign.play(kind, range(total), total))
            if tally.wrong and not to_the_end:
                break
        self.choose(0)
        return tally
