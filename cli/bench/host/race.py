"""Other renderers beside ours, each in turn with ours so that both meet the same machine."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from . import peers
from .frames import build

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.config import EngineConfig
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View

__all__ = ["OURS", "Subject", "race"]

OURS = "Splatline, host and golden"

QUALITY = "fast"


class Subject(NamedTuple):
    """A scene of the race: a cloud, its view, and the radius of each disc."""

    cloud: Cloud
    view: View
    radii: npt.NDArray[np.float64]


def race(
    subjects: Sequence[Subject],
    preset: EngineConfig,
    announce: Callable[[str], None],
) -> list[dict[str, Any]]:
    """Return our frame of each subject and that of every peer.

    Ours is drawn before and after each peer, and the faster of both counts: a machine that others
    use too slows down and recovers.

    Parameters
    ----------
    subjects, preset
        What is drawn, and the engine that golden draws for.
    announce
        Called with a description before each renderer.

    Returns
    -------
    list of dict
        ``cloud``, ``points``, ``peer``, ``seconds`` of a frame, ``build_seconds`` (once a cloud;
        None if it was not measured); of a peer ``ours`` (our seconds beside it) and ``ratio`` of
        its seconds to ours, or ``why`` it has not run.
    """
    from splatline.host.pipeline import make_frame
    from splatline.sim import golden

    found = []
    for subject in subjects:
        cloud, view, radii = subject
        index, facts = build(cloud, radii)

        def draw_ours(index: Any = index, view: View = view) -> float:
            begin = time.perf_counter()
            golden.render(make_frame(index, view, quality=QUALITY, config=preset))
            return time.perf_counter() - begin

        row = {"cloud": cloud.name, "points": len(cloud)}
        least, rivals = float("inf"), []
        for name, draw in peers.PEERS.items():
            announce(f"{cloud.name}, {name}")
            before = peers.least_seconds(draw_ours)
            times, why = _attempt(draw, subject)
            rival: dict[str, Any] = {**row, "peer": name}
            if times is None:
                rival |= {"seconds": None, "why": why}
            else:
                best = min(before, peers.least_seconds(draw_ours))
                rival |= {"seconds": times.frame, "build_seconds": times.build, "ours": best}
                rival["ratio"] = times.frame / best
            least = min(least, before, rival.get("ours", before))
            rivals.append(rival)
        made = facts["index_seconds"]
        found.append({**row, "peer": OURS, "seconds": least, "build_seconds": made, "ratio": 1.0})
        found += rivals
    return found


def _attempt(draw: Callable[..., peers.Times], subject: Subject) -> tuple[peers.Times | None, str]:
    """Return a peer's times, or None and the reason of its failure."""
    from .embree import EmbreeMissingError

    try:
        return draw(*subject), ""
    except ModuleNotFoundError as error:
        return None, f"{error.name} is not installed: pip install '.[peers]'"
    except EmbreeMissingError as error:
        return None, str(error)
    except Exception as error:  # a peer may fail in any way without stopping the benchmark
        return None, f"{type(error).__name__}: {error}"[:200]
