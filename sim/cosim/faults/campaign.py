"""The campaign: ``python -m splatline.sim.cosim.faults --preset paper --count 100000``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from splatline.contract.config import EngineConfig

from .axi_stock import AxiStock
from .bus_trials import abort_trials, access_trials
from .counter_trials import counter_trials
from .model import Model
from .packet_trials import packet_trials
from .records import Batch, Phase
from .reset_trials import reset_trials
from .stall_trials import stall_trials
from .stock import SIZES, Stock, writes_of
from .stream_trials import initial_trials, nonsense_trials, stream_trials
from .tally import Tally
from .trial import Trial, cycle_bound, faults_of, phase
from .upset_trials import OUTCOMES, outcome_of, upset_trials
from .write_trials import write_trials

__all__ = ["CHUNK", "Campaign", "kinds_of"]

CHUNK = 250
"""Trials that are played together. Each such chunk begins with a reset and a seed of its own."""

Maker = Callable[..., Iterator[Trial]]

ENGINE: dict[str, tuple[Maker, float]] = {
    "stalls": (stall_trials, 0.12),
    "resets": (reset_trials, 0.12),
    "table writes": (write_trials, 0.12),
    "streams": (stream_trials, 0.22),
    "words of any bits": (nonsense_trials, 0.16),
    "initial rasters": (initial_trials, 0.10),
}
"""Generator of the trials of a kind at an engine's own ports, and their share of the campaign."""

AXI: dict[str, tuple[Maker, float]] = {
    "stalls": (stall_trials, 0.10),
    "resets": (reset_trials, 0.10),
    "packets": (packet_trials, 0.24),
    "words of any bits": (nonsense_trials, 0.16),
    "initial rasters": (initial_trials, 0.08),
    "accesses of the bus": (access_trials, 0.10),
    "aborts": (abort_trials, 0.06),
}
"""The same for the AXI top."""

ACCESS = 8
"""Cycles of an access of the register bus, more than a table write takes."""

UPSETS = 0.16
"""Share of upsets."""

COUNTERS = 0.08
"""Share of films with their counters, on top of the others: with 100,000 trials more than 90,000
frames, an hour of a film."""

MAKERS = {"engine": ENGINE, "axi": AXI}


def kinds_of(top: str) -> dict[str, float]:
    """Return the kinds of trials of a top, and the share of each in the campaign."""
    makers = {kind: share for kind, (_, share) in MAKERS[top].items()}
    return {**makers, "upsets": UPSETS, **({"counters": COUNTERS} if top == "axi" else {})}


class Campaign:
    """Trials of one engine.

    Parameters
    ----------
    config
        The engine's configuration.
    seed
        Of all that is random.
    top
        One of ``flow.tops.TOPS``: ``engine`` or ``axi``.
    edit
        Changes the Verilog, such as to plant a fault.
    """

    def __init__(
        self,
        config: EngineConfig,
        seed: int = 1,
        *,
        top: str = "engine",
        edit: Callable[[str], str] = lambda text: text,
    ) -> None:
        self.config, self.seed, self.top = config, seed, top
        self.model = Model(config, top, edit=edit)
        self.stock: Any = (AxiStock if top == "axi" else Stock)(config, seed)
        self.limbs = -(-config.raster_end.end // 64)

    def play(self, kind: str, numbers: range, total: int) -> Tally:
        """Play the trials of a kind with some numbers; the same at any time."""
        place = list(kinds_of(self.top)).index(kind)
        rng = np.random.default_rng([self.seed, place, numbers.start])
        if kind == "upsets":
            pairs = list(upset_trials(self.stock, rng, numbers, self.model.registers()))
            trials = [trial for trial, _ in pairs]
        else:
            make = counter_trials if kind == "counters" else MAKERS[self.top][kind][0]
            trials = list(make(self.stock, rng, numbers, total))
        parts = [self._first(), *(part for trial in trials for part in trial.phases)]
        batch = Batch(parts, self.limbs)
        played = self.model.play(batch)
        results = played.results
        tally = Tally(
            trials=len(trials),
            cycles=int(results["cycles"].sum()),
            words=int(results["words"].sum()),
            frames=int(results["closed"].sum()),
        )
        at = 1
        for number, trial in zip(numbers, trials, strict=True):
            phases = slice(at, at + len(trial.phases))
            at = phases.stop
            frames = [played.frames[begin:end] for begin, end in batch.phases["frames"][phases]]
            if kind == "upsets":
                part = pairs[number - numbers.start][1]
                outcome = OUTCOMES[outcome_of(trial, results[phases], frames)]
                where = "memory" if part.rows > 1 else "register"
                tally.outcomes[_short(part.module), where, outcome] += 1
                continue
            written = [played.written[begin:end] for begin, end in batch.phases["writes"][phases]]
            bounds = [self._bound(part) for part in trial.phases]
            wrong = faults_of(trial, results[phases], frames, written, bounds)
            if wrong:
                tally.wrong.append(f"{kind} {number}, {trial.name}: {'; '.join(wrong)}")
            tally.silence = max(tally.silence, int(results[phases]["silence"].max()))
            tally.nearest = max(tally.nearest, float((results[phases]["cycles"] / bounds).max()))
        return tally

    def _first(self) -> Phase:
        """Return a phase that resets the engine and writes all tables."""
        item, writes = self.stock.items[SIZES[0], "empty"], self.stock.setup(SIZES[0])
        tables = writes_of([*self.stock.materials, *writes])
        return phase(item.words, SIZES[0], self.config, item.digests, writes=tables, reset_edges=1)

    def _bound(self, part: Phase) -> float:
        """Return the most cycles of a phase; any number if a port stalls or a write comes late."""
        calm = not np.any(part.settings.get("stalls", 0)) and part.settings["reset_at"] < 0
        if not calm or len(part.writes) > part.settings["hold"]:
            return math.inf
        a_write = ACCESS if self.top == "axi" else 0
        return float(cycle_bound(self.config, part) + a_write * len(part.writes))


def _short(module: str) -> str:
    """Return a module's name without the top's, and with all lanes as one."""
    name = module.removeprefix("splatline").removeprefix("__").replace("__", ".") or "top"
    return re.sub(r"(_\d+)+$", "", name)
