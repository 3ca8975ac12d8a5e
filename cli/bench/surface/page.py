"""The Markdown page of ``splatline bench surface``."""

from __future__ import annotations

import itertools
from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["page"]

GOAL = 5e-4
"""Share of the pixels drawn that may be open."""

INTRODUCTION = """\
# The surface that a person sees

Made by `splatline bench surface`: {width} x {height} pixels, preset {preset}, {versions}. The
built-in scenes are sampled anew, and their pictures compared with the true surface, which is
rendered without points (`sim/reference/true_surface.py`).

- **Density**: points that face the eye, a pixel of the true surface. Even points follow a lattice.
- **Noise**: along the normal, in spacings of the points.
- **Pinholes**: background pixels of which at least 7 of the 8 neighbours are drawn.
- **See-through**: drawn pixels more than 25/511 of the depth range behind the median of their
  3 x 3 neighbours. Where a thin part ends before a far one, a true surface has some as well.
- **Both**: pinholes and see-through pixels together.
- **Behind**: drawn pixels as far behind all of the true surface in their neighbourhood.
- **Holes**: background among the pixels that the true surface covers fully.

Specks are closed, as in every picture of `splatline render`
([0104](../decisions/0104-specks-are-closed-in-the-image.md)): what is counted is left after that.

Shares are of the pixels drawn, in percent; PSNR is in dB. Pixels are drawn with one sample, the
truth with 16. The terrain's given normals are smoother than its shape. So the truth is shaded by
them where normals are given, and by the shape's own where they are estimated.
"""


CLOUDS = """
## Clouds

512 x 512 pixels, the default view. Of each scan there are samples of its discs, four times as many
points. *Dense* ones have their discs' normals. *Noisy* ones are moved along these normals by 0.7 of
the median radius (standard deviation), and their normals are estimated. Of the largest scan there
are two samples more, with their discs' normals.

A *gap* is an area of background of at most 40 pixels with no other background within three pixels.
The table has the pixels of the largest. A scan may have true ones, as between leaves.

Of {total} clouds {reached} have at most {goal} % of both. No true surface of a scan is known: where
a near part ends before a far one, both are drawn in neighbouring pixels and count as see-through.
"""


def page(report: dict[str, Any]) -> str:
    """Return the report as Markdown."""
    width, height = report["size"]
    versions = ", ".join(f"{name} {number}" for name, number in report["versions"].items())
    parts = [
        INTRODUCTION.format(width=width, height=height, preset=report["preset"], versions=versions),
        "## The true surfaces' own\n",
        table(
            ("scene", "pinholes", "see-through"),
            [
                (truth["scene"], _percent(truth["pinholes"]), _percent(truth["see_through"]))
                for truth in report["truths"]
            ],
            1,
        ),
    ]
    parts += ["\n## The goal\n", *_goal(report)]
    heads = ("noise", "normals", "density", "points", "splat, px", "PSNR", "silhouette IoU",
             "pinholes", "see-through", "both", "behind", "holes", "elements")  # fmt: skip
    cases = dict.fromkeys((run["scene"], run["spread"]) for run in report["runs"])
    for scene, spread in cases:
        rows = [
            _row(run) for run in report["runs"] if run["scene"] == scene and run["spread"] == spread
        ]
        name = f"{scene}, points {'spread evenly' if spread == 'even' else 'at random'}"
        parts += [f"\n## {name}\n", table(heads, rows, ("normals",))]
    if report["clouds"]:
        heads = ("cloud", "points", "splat, px", "pinholes", "see-through", "both", "gap, px",
                 "elements", "words")  # fmt: skip
        parts += [
            _verdict(report["clouds"]),
            table(heads, [_cloud(run) for run in report["clouds"]], 1),
        ]
    parts.append("\n![PSNR, holes and silhouette by density](surface.png)")
    return "\n".join(parts) + "\n"


def _verdict(clouds: list[dict[str, Any]]) -> str:
    """Return the introduction of the clouds' table, with how many reach the goal."""
    reached = sum(run["pinholes"] + run["see_through"] <= GOAL for run in clouds)
    return CLOUDS.format(total=len(clouds), reached=reached, goal=_percent(GOAL))


def _goal(report: dict[str, Any]) -> list[str]:
    """Return how many runs reach the goal, by noise, and where PSNR falls as density grows."""
    runs = report["runs"]
    own = {truth["scene"]: truth["see_through"] for truth in report["truths"]}
    rows = []
    for noise in dict.fromkeys(run["noise"] for run in runs):
        cases = [run for run in runs if run["noise"] == noise and run["density"] >= 1.0]
        both = [run["pinholes"] + run["see_through"] for run in cases]
        shares = (
            both,
            [share - own[run["scene"]] for share, run in zip(both, cases, strict=True)],
            [run["pinholes"] + (run["behind_truth"] or 0.0) for run in cases],
        )
        if cases:
            counts = (
                f"{sum(share <= GOAL for share in each)}, {_percent(max(each))}" for each in shares
            )
            rows.append((f"{noise:g}", str(len(cases)), *counts))
    falls = []
    for one, other in itertools.pairwise(runs):
        case = [one[key] == other[key] for key in ("scene", "spread", "noise", "normals")]
        if all(case) and other["psnr_db"] < one["psnr_db"]:
            falls.append(
                f"{one['scene']}, {one['spread']}, noise {one['noise']:g}, normals"
                f" {'given' if one['normals'] else 'estimated'}: {one['psnr_db']:.1f} ->"
                f" {other['psnr_db']:.1f} dB from {one['density']:g} to {other['density']:g}"
            )
    return [
        f"At most {_percent(GOAL)} % from 1 point a pixel: runs that reach it, and the worst in"
        " percent. The true surface has see-through pixels of its own. So they are counted in three"
        " ways: all of them; less the share that the true surface has; only those behind all of"
        " the true surface near them. Noise lifts and tilts points, so that gaps are larger than"
        " a pixel.\n",
        table(
            (
                "noise",
                "runs",
                "pinholes and see-through",
                "less the surface's own",
                "pinholes and behind",
            ),
            rows,
            0,
        ),
        "\nPSNR falls as density grows: " + ("; ".join(falls) if falls else "nowhere") + ".",
    ]


def _row(run: dict[str, Any]) -> tuple[str, ...]:
    return (
        f"{run['noise']:g}",
        "given" if run["normals"] else "estimated",
        f"{run['density']:g}",
        f"{run['points']:,}",
        f"{run['splat_pixels']:.2f}",
        f"{run['psnr_db']:.1f}",
        f"{run['silhouette_iou']:.4f}",
        *(
            _percent(share)
            for share in (
                run["pinholes"],
                run["see_through"],
                run["pinholes"] + run["see_through"],
                run["behind_truth"],
                run["hole_fraction"],
            )
        ),
        f"{run['elements']:,}",
    )


def _cloud(run: dict[str, Any]) -> tuple[str, ...]:
    return (
        run["cloud"],
        f"{run['points']:,}",
        f"{run['splat_pixels']:.2f}",
        _percent(run["pinholes"]),
        _percent(run["see_through"]),
        _percent(run["pinholes"] + run["see_through"]),
        f"{run['largest_gap']}",
        f"{run['elements']:,}",
        f"{run['codewords']:,}",
    )


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100.0 * share:.3f}"
