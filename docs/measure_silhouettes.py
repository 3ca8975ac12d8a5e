"""Compare the silhouettes of two versions of Splatline with those of the true surfaces.

Run ``.venv/bin/python docs/measure_silhouettes.py write FOLDER`` first: it writes the points of
``splatline bench surface``, their views and their true silhouettes. Then run ``draw FOLDER NAME``
in the environment of each version: it draws the points as that version does and writes the
silhouette IoU of each run to ``FOLDER/NAME.json``. ``compare FOLDER OLD NEW`` prints how far it
rose or fell.
"""

from __future__ import annotations

import dataclasses
import inspect
import itertools
import json
import sys
from pathlib import Path

import numpy as np

from splatline.contract.presets import PRESETS
from splatline.host.cloud import spacing
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.normals import estimate_normals
from splatline.host.pipeline import make_frame, make_frames
from splatline.host.visibility.view import View
from splatline.sim import golden

DENSITIES = (0.1, 0.3, 1.0, 3.0, 10.0, 40.0)
NOISES = (0.0, 0.5, 2.0)


def write(folder: Path) -> None:
    """Write the points, the view and the true silhouette of each run."""
    from splatline.cli.bench.surface import measure

    folder.mkdir(parents=True, exist_ok=True)
    for scene in measure.SCENES:
        subject = measure._subject(scene, (256, 256))
        view = dataclasses.asdict(subject.view)
        for case in itertools.product(("even", "random"), NOISES, (True, False), DENSITIES):
            spread, noise, has_normals, density = case
            cloud = measure._sample(subject, density, spread, noise, has_normals)
            np.savez(
                folder / ("_".join(map(str, (scene, *case))) + ".npz"),
                positions=cloud.positions,
                normals=cloud.normals,
                colours=cloud.colours,
                origin=cloud.origin,
                has_normals=has_normals,
                mask=subject.truth.coverage > 0.5,
                **{f"view_{name}": value for name, value in view.items()},
            )


def draw(folder: Path, name: str) -> None:
    """Draw each run as this version does; write its IoU."""
    options = {"config": PRESETS["rgb24"]}
    if "close_specks" in inspect.signature(make_frames).parameters:
        options["close_specks"] = True
    fields = {field.name for field in dataclasses.fields(Cloud)}
    found = {}
    for path in sorted(folder.glob("*.npz")):
        saved = np.load(path)
        positions, is_known = saved["positions"], bool(saved["has_normals"])
        normals = saved["normals"] if is_known else estimate_normals(positions)
        parts = {"positions": positions, "normals": normals, "colours": saved["colours"]}
        parts |= {"name": path.stem, "origin": saved["origin"], "dropped": {}}
        if "two_sided" in fields:
            parts["two_sided"] = np.full(len(positions), not is_known)
        cloud = Cloud(**parts)
        view = {key[5:]: saved[key] for key in saved.files if key.startswith("view_")}
        view |= {key: int(view[key]) for key in ("width", "height")}
        view |= {key: float(view[key]) for key in ("focal", "near")}
        view["shift"] = tuple(view["shift"])
        if hasattr(spacing, "measure_discs"):
            discs = spacing.measure_discs(cloud)._asdict()
        else:
            discs = {"radii": spacing.splat_radii(cloud)}
        frame = make_frame(cloud, View(**view), **discs, **options)
        drawn, mask = golden.render(frame).drawn, saved["mask"]
        found[path.stem] = float(np.sum(drawn & mask) / np.sum(drawn | mask))
        print(f"{path.stem}: {found[path.stem]:.4f}", flush=True)
    (folder / f"{name}.json").write_text(json.dumps(found))


def compare(folder: Path, old: str, new: str) -> None:
    """Print the change of the IoU: its mean, and the runs in which it fell most."""
    before, after = (json.loads((folder / f"{name}.json").read_text()) for name in (old, new))
    change = {name: after[name] - before[name] for name in before}
    dense = [by for name, by in change.items() if float(name.split("_")[-1]) >= 1.0]
    for what, values in (("all runs", [*change.values()]), ("from 1 point a pixel", dense)):
        fell = sum(value < -0.001 for value in values)
        print(f"{what}: {len(values)}, mean {np.mean(values):+.4f}, least {min(values):+.4f}; "
              f"{fell} fell by more than 0.001")  # fmt: skip
    for name in sorted(change, key=lambda name: change[name])[:20]:
        print(f"{name}: {before[name]:.4f} -> {after[name]:.4f}")


if __name__ == "__main__":
    command, folder, *names = sys.argv[1:]
    {"write": write, "draw": draw, "compare": compare}[command](Path(folder), *names)
