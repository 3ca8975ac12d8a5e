"""Measure the cycles that a dense frame spends on flushes, and on loading an initial raster.

Run as ``.venv/bin/python docs/measure_load.py [ENGINE ...]``; without arguments it measures
``paper``, ``rgb24`` and ``swift``. ``rgb24-simple`` is ``rgb24`` with simple memories. It simulates
the built-in scenes, 512 x 512, in the generated Verilog. Each is drawn as an engine's second frame,
once over background and once over its own picture, so that every word is loaded and flushed. It
prints the cycles, and their excess over one cycle for each code word, which is the least possible.
Splats have the diameter of the scene's spacing, times 0.7, 1 and 4/3.
"""

from __future__ import annotations

import sys

from splatline.contract.presets import PRESETS
from splatline.contract.variants import VARIANTS
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.scenes.scenes import SCENES
from splatline.sim import golden
from splatline.sim.cosim.player.frames import Job, play

SIMPLE = [config.with_memory("simple") for config in PRESETS.values() if not config.draws_blocks]
ENGINES = PRESETS | {config.name: config for config in (*VARIANTS, *SIMPLE)}

SCALES = (0.7, 1.0, 4 / 3)


def main() -> None:
    """Print a row for each scene, size and preset."""
    heads = ("scene", "splats", "preset", "code words", "raster words", "cycles", "more")
    print("| " + " | ".join([*heads, "over a picture", "more"]) + " |")
    print("|---|---:|---|" + "---:|" * 6)
    for name in sys.argv[1:] or ("paper", "rgb24", "swift"):
        config = ENGINES[name]
        for scene_name in SCENES:
            scene = load_scene(scene_name)
            seen = {"orbit": scene.orbit, "fov": scene.fov, "up": scene.up, "zoom": scene.zoom}
            view = fit_view(scene.cloud, **seen)
            radii = splat_radii(scene.cloud)
            for scale in SCALES:
                frame = make_frame(scene.cloud, view, radii=scale * radii, config=config)
                picture = golden.render(frame)
                words = picture.drawn.reshape(frame.height, -1, config.raster_pixels)
                jobs = [Job(frame=frame), Job(frame=frame), Job(frame=frame, initial=picture)]
                outcomes = play(jobs)[1:]
                if any(outcome.raster.mismatches(picture) for outcome in outcomes):
                    raise SystemExit(f"{name}: the Verilog's {scene_name} is not golden's")
                least = len(frame.codewords)
                row = [f"{least:,}", f"{words.any(axis=-1).sum():,}"]
                for outcome in outcomes:
                    row += [f"{outcome.cycles:,}", f"{outcome.cycles / least - 1:.1%}"]
                print(
                    f"| {scene_name} | x {scale:.2f} | {name} | " + " | ".join(row) + " |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
