"""Other renderers on the page of ``splatline bench host``, and the goals beside Embree."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table
from splatline.cli.bench.sizes import LARGE, MEDIUM

__all__ = ["EMBREE", "GOALS", "rivals"]

EMBREE = "Embree discs"

GOALS = ((MEDIUM, 18 / 21), (LARGE, 45 / 54))
"""Points of a cloud, and the most that our frame may take of Embree's. A cloud of other size has
the goal of the last that is not larger."""

MISSED = (
    "Our frame grows with the points that may be seen and the splats that are drawn; Embree's grows"
    " with the pixels"
)
"""Why a goal is missed."""

WORDS = {"cloud", "renderer"}


def rivals(peers: list[dict[str, Any]]) -> list[str]:
    """Return the section on other renderers; nothing if none was measured."""
    if not peers:
        return []
    rows = table(
        ("cloud", "renderer", "frame, ms", "times ours", "built once, ms"),
        [_row(peer) for peer in peers],
        WORDS,
    )
    goals = [line for peer in peers if peer["peer"] == EMBREE and (line := _goal(peer))]
    return [
        "",
        "## Other renderers",
        "",
        "Milliseconds a frame on the same cores in the same run, and the ratio to ours (`fast`,"
        " host and golden), which is drawn before and after each. Embree casts a ray through the"
        " middle of each pixel at the same discs, and shades with one diffuse light. Built once a"
        " cloud: our index, Embree's tree.",
        "",
        rows,
        *(["", *goals] if goals else []),
    ]


def _row(peer: dict[str, Any]) -> tuple[str, ...]:
    if peer["seconds"] is None:
        return peer["cloud"], peer["peer"], "not run", peer["why"], "-"
    built = peer["build_seconds"]
    return (
        peer["cloud"],
        peer["peer"],
        f"{1e3 * peer['seconds']:.1f}",
        f"{peer['ratio']:.2f}",
        "-" if built is None else f"{1e3 * built:.0f}",
    )


def _goal(peer: dict[str, Any]) -> str:
    """Return our share of Embree's frame and the goal for it; nothing if there is none."""
    limit = next((most for points, most in reversed(GOALS) if peer["points"] >= points), None)
    if limit is None or peer["seconds"] is None:
        return ""
    share = peer["ours"] / peer["seconds"]
    verdict = "met" if share <= limit else "missed"
    reason = "" if share <= limit else f". {MISSED}"
    told = f"ours takes {share:.3f} of Embree's; goal {limit:.3f}: {verdict}"
    return f"- {peer['cloud']}: {told}{reason}"
