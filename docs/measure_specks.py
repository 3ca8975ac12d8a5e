"""Measure the specks of scans and of samples of them: which could be closed, and by what.

Run as ``.venv/bin/python docs/measure_specks.py SCAN ... [--pictures FOLDER]``. Specks are pinholes
and see-through pixels of the default picture, as ``splatline bench surface`` counts them on the
same clouds. A pinhole is closed in another picture if its pixel is drawn there; a see-through
pixel, if it lies behind all that is drawn there in its 3 x 3 neighbourhood. Where a near part truly
ends before a far one, it does not.

Printed are, in percent of the pixels drawn: pinholes, see-through pixels, and of both together the
part that is closed without the skip ``facing_away``, that with discs a pixel larger in radius, that
with both, and the part that stays open. What larger discs close is an upper bound of what discs of
the right size would close, as they close true gaps of a pixel as well.
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter

from splatline.cli.bench.machine import described
from splatline.cli.bench.surface.measure import samples_of
from splatline.host import fit_view, read_cloud
from splatline.host.cloud.spacing import measure_discs
from splatline.host.pipeline import make_frame
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.plots.figure import png_bytes
from splatline.sim import golden
from splatline.sim.reference.wholeness import STEP, pinholes, see_through

GREY = (0.1, 0.1, 0.1)

TWO_SIDED = DEFAULT_SKIPS - {"facing_away"}


def share_of(raster):
    """Return the depth of a raster as a share of the depth range."""
    return raster.depth / (raster.config.background_depth - 1)


def closed(holes, seen, depth, raster):
    """Return the specks that another picture closes; ``depth`` is that of the first one."""
    known = np.where(raster.drawn, share_of(raster), np.inf)
    furthest = maximum_filter(known, size=3, mode="nearest")
    return (holes & raster.drawn) | (seen & (depth > furthest + STEP))


def tell(name, cloud, view, picture):
    """Print the row of a cloud, and write its picture."""
    radii, thin, _ = measure_discs(cloud)
    wider = radii + np.maximum((cloud.positions - view.eye) @ view.axes[2], 0.0) / view.focal
    frame = make_frame(cloud, view, radii=radii, thin=thin)
    raster = golden.render(frame)
    if picture:
        picture.write_bytes(png_bytes(np.uint8(255.0 * raster.to_rgb(GREY) + 0.5)))
    holes, seen = pinholes(raster.drawn), see_through(share_of(raster), raster.drawn)
    specks = holes | seen
    limits = frame.counts["depth_range"]
    closes = []
    for sizes, skips in ((radii, TWO_SIDED), (wider, DEFAULT_SKIPS), (wider, TWO_SIDED)):
        other = make_frame(
            cloud, view, radii=sizes, thin=thin, skips=skips, depth_range=tuple(limits)
        )
        closes.append(closed(holes, seen, share_of(raster), golden.render(other)))
    masks = holes, seen, specks, *closes, specks & ~closes[-1]
    shares = [100.0 * np.count_nonzero(mask) / np.count_nonzero(raster.drawn) for mask in masks]
    print(f"| {name} | {' | '.join(f'{share:.3f}' for share in shares)} |", flush=True)


def main():
    """Measure each scan as it is, a dense and a noisy sample of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scans", nargs="+", type=Path)
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    print(f"{described()}; 512 x 512 pixels, the default view\n")
    print("| cloud | pinholes | see-through | both | two-sided | larger | both closed | open |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for path in options.scans:
        scan = read_cloud(path)
        view = fit_view(scan)
        for number, (name, cloud) in enumerate(samples_of(scan)):
            picture = options.pictures and options.pictures / f"{path.stem}_{number}.png"
            tell(name, cloud, view, picture)


if __name__ == "__main__":
    main()
