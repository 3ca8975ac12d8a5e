"""Measure what closing specks does to the error against the true surface, and to time.

Run as ``.venv/bin/python docs/measure_closing.py [SCAN ...] [--pictures FOLDER]``. The scenes of
``splatline bench surface``, sampled at random, are drawn with their specks and closed.

Of each scan, a dense and a noisy sample of it the enclosed areas of background are counted that
have at most 40 pixels: those whose pixels touch at their sides, and, in brackets, those that do not
touch other background at a corner either. Of each scan the times of a frame from its index are
printed, of golden's picture of it, and of closing.
"""

import argparse
import time
from pathlib import Path

import numpy as np
from scipy.ndimage import label

from splatline.cli.bench.machine import described
from splatline.cli.bench.surface import measure
from splatline.contract.presets import DEFAULT
from splatline.host import fit_view, read_cloud
from splatline.host.cloud.spacing import measure_discs, splat_radii
from splatline.host.encode.close_specks import close_specks
from splatline.host.pipeline import make_frame
from splatline.host.stages import Stopwatch, indexed
from splatline.plots.figure import png_bytes
from splatline.sim import golden
from splatline.sim.reference import metrics
from splatline.sim.reference.wholeness import behind_truth, wholeness

SIZE = 256, 256
DENSITY = 4.0
REPEATS = 15
MOST_PIXELS = 40
MEASURES = "psnr_db", "silhouette_iou", "hole_fraction", "pinholes", "see_through", "behind"


def measures(frame, truth):
    """Return the measures of a frame's picture."""
    raster, limits = golden.render(frame), frame.counts["depth_range"]
    found = metrics.compare(raster, truth, depth_range=limits) | wholeness(raster)
    return found | {"behind": behind_truth(raster, truth, limits)}


def tell_errors():
    """Print a row for each scene, noise and kind of normals."""
    heads = "PSNR, dB", "silhouette IoU", "holes, %", "pinholes, %", "see-through, %", "behind, %"
    print(f"| cloud | {' | '.join(heads)} |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name in measure.SCENES:
        subject = measure._subject(name, SIZE)
        for noise in (0.0, 0.5, 2.0):
            for normals in (True, False):
                cloud = measure._sample(subject, DENSITY, "random", noise, normals)
                frame = make_frame(cloud, subject.view, radii=splat_radii(cloud), config=DEFAULT)
                pairs = [measures(each, subject.truth) for each in (frame, close_specks(frame))]
                cells = []
                for key in MEASURES:
                    scale, digits = {"psnr_db": (1, 2), "silhouette_iou": (1, 4)}.get(key, (100, 3))
                    cells.append(" -> ".join(f"{scale * one[key]:.{digits}f}" for one in pairs))
                kind = f"{name}, noise {noise:g}, {'' if normals else 'no '}normals"
                print(f"| {kind} | {' | '.join(cells)} |", flush=True)


def areas_of(raster):
    """Return the cell of a picture: small areas of background, and the pixels of the largest."""
    found = []
    for structure in (None, np.ones((3, 3))):
        numbers, count = label(~raster.drawn, structure)
        sizes = np.bincount(numbers.ravel(), minlength=count + 1)[1:]
        found.append(sizes[sizes <= MOST_PIXELS])
    return f"{len(found[0])} ({len(found[1])}), {max(found[0], default=0)}"


def tell_areas(scans, pictures):
    """Print a row for each scan and sample, and write its closed picture."""
    print(f"\n| cloud | areas of at most {MOST_PIXELS} pixels, pixels of the largest |\n|---|---:|")
    for path in scans:
        scan = read_cloud(path)
        view = fit_view(scan)
        for number, (name, cloud) in enumerate(measure.samples_of(scan)):
            radii, thin, _ = measure_discs(cloud)
            frame = make_frame(cloud, view, radii=radii, thin=thin, config=DEFAULT)
            rasters = [golden.render(each) for each in (frame, close_specks(frame))]
            print(f"| {name} | {' -> '.join(map(areas_of, rasters))} |", flush=True)
            if pictures:
                picture = np.uint8(255.0 * rasters[1].to_rgb((1.0, 1.0, 1.0)) + 0.5)
                (pictures / f"{path.stem}_{number}.png").write_bytes(png_bytes(picture))


def tell_times(scans):
    """Print a row of times for each scan."""
    print("\n| scan | code words | specks | frame, ms | golden, ms | closing, ms |")
    print("|---|---:|---:|---:|---:|---:|")
    for path in scans:
        cloud = read_cloud(path)
        discs, view = measure_discs(cloud), fit_view(cloud)
        index = indexed(cloud, discs.radii, discs.thin, None, DEFAULT, Stopwatch())
        best = {}
        for _ in range(REPEATS):
            clock = Stopwatch()
            frame = make_frame(index, view, config=DEFAULT)
            clock.lap("frame")
            golden.render(frame)
            clock.lap("golden")
            closed = close_specks(frame)
            clock.lap("closing")
            best = {name: min(best.get(name, 1e9), lap) for name, lap in clock.laps.items()}
            time.sleep(0.01)
        laps = " | ".join(f"{1e3 * seconds:.1f}" for seconds in best.values())
        words, specks = len(frame.codewords), closed.counts["specks"]
        print(f"| {path.stem} | {words:,} | {specks} | {laps} |", flush=True)


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scans", nargs="*", type=Path)
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    print(f"{described()}; {SIZE[0]} x {SIZE[1]} pixels, {DENSITY:g} points a pixel, at random\n")
    tell_errors()
    tell_areas(options.scans, options.pictures)
    tell_times(options.scans)


if __name__ == "__main__":
    main()
