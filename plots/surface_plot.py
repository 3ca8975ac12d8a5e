"""The plot of ``splatline bench surface``: error by density."""

from __future__ import annotations

import io
from typing import Any

__all__ = ["plot_surface"]

STYLES = {
    ("even", True): "-",
    ("even", False): "--",
    ("random", True): "-.",
    ("random", False): ":",
}
"""Lines by how points are spread and whether normals are given."""

COLOURS = ("#2a78b5", "#d1702c", "#7a5aa8")
"""By noise, in order."""

PANELS = (
    ("psnr_db", "PSNR, dB"),
    ("visible", "pinholes and behind, %"),
    ("silhouette_iou", "silhouette IoU"),
)


def plot_surface(runs: list[dict[str, Any]]) -> bytes:
    """Return the plot of each scene's measures by density, as a PNG."""
    from matplotlib.figure import Figure

    scenes = list(dict.fromkeys(run["scene"] for run in runs))
    noises = sorted({run["noise"] for run in runs})
    figure = Figure(figsize=(13.0, 4.2 * len(scenes)), layout="constrained")
    axes = figure.subplots(len(scenes), len(PANELS), squeeze=False)
    for row, scene in zip(axes, scenes, strict=True):
        for panel, (key, label) in zip(row, PANELS, strict=True):
            for (spread, normals), style in STYLES.items():
                for noise, colour in zip(noises, COLOURS, strict=False):
                    line = [
                        (run["density"], _value(run, key))
                        for run in runs
                        if (run["scene"], run["spread"]) == (scene, spread)
                        and (run["normals"], run["noise"]) == (normals, noise)
                    ]
                    name = f"{spread}, {'normals' if normals else 'none'}, noise {noise:g}"
                    panel.plot(*zip(*line, strict=True), style, color=colour, label=name)
            panel.set_xscale("log")
            panel.set_xlabel("points a pixel")
            panel.set_ylabel(label)
            panel.set_title(scene)
            panel.grid(alpha=0.3)
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=8)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()


def _value(run: dict[str, Any], key: str) -> float:
    if key == "visible":
        return float(100.0 * (run["pinholes"] + run["behind_truth"]))
    return float(run[key])
