"""The Markdown page of ``splatline bench surface``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["page"]

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
- **Behind**: drawn pixels as far behind all of the true surface in their neighbourhood.
- **Holes**: background among the pixels that the true surface covers fully.

Shares are of the pixels drawn, in percent; PSNR is in dB. Pixels are drawn with one sample, the
truth with 16. The true terrain is shaded by smoothed normals; what is estimated from very many of
its points has the grid's own facets, which lowers the PSNR.
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
    heads = ("noise", "normals", "density", "points", "splat, px", "PSNR", "silhouette IoU",
             "pinholes", "see-through", "behind", "holes", "elements")  # fmt: skip
    cases = dict.fromkeys((run["scene"], run["spread"]) for run in report["runs"])
    for scene, spread in cases:
        rows = [
            _row(run) for run in report["runs"] if run["scene"] == scene and run["spread"] == spread
        ]
        name = f"{scene}, points {'spread evenly' if spread == 'even' else 'at random'}"
        parts += [f"\n## {name}\n", table(heads, rows, ("normals",))]
    if report["clouds"]:
        heads = ("cloud", "points", "splat, px", "pinholes", "see-through", "elements", "words")
        parts += [
            "\n## Clouds\n\n512 x 512 pixels, the default view.\n",
            table(heads, [_cloud(run) for run in report["clouds"]], 1),
        ]
    parts.append("\n![PSNR, holes and silhouette by density](surface.png)")
    return "\n".join(parts) + "\n"


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
            _percent(run[key])
            for key in ("pinholes", "see_through", "behind_truth", "hole_fraction")
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
        f"{run['elements']:,}",
        f"{run['codewords']:,}",
    )


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100.0 * share:.3f}"
