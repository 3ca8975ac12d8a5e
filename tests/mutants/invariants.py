"""What holds in both windows while they run in lockstep: see :mod:`.cleared`."""

import itertools
from dataclasses import replace

from .aig import Aig
from .clearing import Clearing, bits_of
from .lockstep import Builder
from .renamed import Renaming

__all__ = ["invariants"]

QUIET = ("flush_scan.flush__valid", "flush_scan.taking", "flush_scan.pairs", "readout.flushed")
"""Registers that are 0 while the memories are cleared: nothing is flushed."""


def invariants(
    aig: Aig, lanes: list[tuple[int, int]], renaming: Renaming | None
) -> tuple[list[int], set[int], Aig]:
    """Return what must stay 0, the registers of the gate that are apart, and the graph with both.

    Registers that may differ are a lane's pixel that was read and its request, the pixels that wait
    on the raster, and the clearing's address. They are the same where they count.
    """
    build = Builder(aig)
    names, apart = aig.names, set()

    def gold(name: str) -> list[int]:
        return bits_of(aig, f"gold.w.{name}")

    def unlike(name: str) -> int:
        own = bits_of(aig, f"gate.w.{name}")
        apart.update(bit & ~1 for bit in own)
        return build.any(*map(build.differ, gold(name), own))

    def wrong_pixel(depth: str, colour: str) -> tuple[int, int]:
        """Return whether depths differ; and whether these do, or colours where they count."""
        background = build.any(*(bit ^ 1 for bit in gold(depth))) ^ 1
        depths = unlike(depth)
        return depths, build.any(depths, build.both(unlike(colour), background ^ 1))

    ((sweeping,), (swept,)) = gold("sweeping"), gold("swept")
    clearing = build.any(sweeping, swept)
    (flushed,), (valid,), (end,) = map(
        gold, ("readout.flushed", "readout.emit_valid", "readout.emit_end")
    )
    wrong = [names["trigger"], build.both(sweeping, swept ^ 1)]
    wrong.append(build.both(clearing, build.any(*(bit for name in QUIET for bit in gold(name)))))
    for i, j in lanes:
        lane = f"lane_{i}_{j}"
        depths, pixel = wrong_pixel(f"{lane}.old_depth", f"{lane}.old_colour")
        (drawn,) = gold(f"{lane}.taken_draw")
        wrong += [build.both(flushed, pixel), build.both(drawn, build.any(depths, clearing))]
        request = [unlike(f"{lane}.taken_{name}") for name in ("draw", "clear")]
        request.append(_wrong_address(aig, build, lane, renaming, apart))
        wrong.append(build.both(clearing ^ 1, build.any(*request)))
    for j in {j for _, j in lanes}:
        _, pixel = wrong_pixel(f"readout.emit_pixels_depth_{j}", f"readout.emit_pixels_colour_{j}")
        wrong.append(build.both(build.both(valid, end ^ 1), pixel))
    wrong += _wrong_sweep(aig, build, apart)
    return wrong, apart, replace(aig, gates=build.gates)


def _wrong_address(
    aig: Aig, build: Builder, lane: str, renaming: Renaming | None, apart: set[int]
) -> int:
    """Return whether the addresses of a lane's request are not the same, or not as renamed."""
    gold, gate = (bits_of(aig, f"{side}.w.{lane}.taken_address") for side in ("gold", "gate"))
    apart.update(bit & ~1 for bit in gate)
    gold = list(gold)
    if renaming:
        control = gold[renaming.control]
        inverts = {"inv": 1, "cnot0": control ^ 1, "cnot1": control}[renaming.mode]
        gold[renaming.bit] = build.differ(gold[renaming.bit], inverts)
    return build.any(*map(build.differ, gold, gate))


def _wrong_sweep(aig: Aig, build: Builder, apart: set[int]) -> list[int]:
    """Return for each register of the gate that has no twin if it is not as it always was.

    While the memories are cleared it is the sum of two bits of the address, or that inverted.
    """
    twins = {
        literal & ~1
        for name, literal in aig.names.items()
        if name.startswith("gate.") and f"gold.{name.removeprefix('gate.')}" in aig.names
    }
    golds = {literal & ~1 for name, literal in aig.names.items() if name.startswith("gold.")}
    lone = [latch for latch in aig.latches if latch not in twins | golds]
    if not lone:
        return []
    sweep = bits_of(aig, "gold.w.sweep")
    run = Clearing(replace(aig, names={**aig.names, "rst": aig.names["in_rst"]}), [*lone, *sweep])
    run.settle(1)
    seen = []
    for _ in range(1 << len(sweep)):
        run.cycle(0)
        seen.append({bit: run.values[bit] for bit in (*lone, *sweep)})
    found = []
    for latch in lone:
        for a, b in itertools.product([0, *sweep], repeat=2):
            values = {one[latch] ^ one.get(a, 0) ^ one.get(b, 0) for one in seen}
            if values in ({0}, {1}):
                apart.add(latch)
                unlike = build.differ(latch, build.differ(a, b)) ^ values.pop()
                found.append(build.both(aig.names["gold.w.sweeping"], unlike))
                break
    return found
