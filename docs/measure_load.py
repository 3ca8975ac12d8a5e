"""Measure what a dense frame pays for the picture that it leaves, and for the one it starts from.

Run as ``.venv/bin/python docs/measure_load.py [ENGINE ...]`` (``paper``, ``rgb24`` and ``swift`` if
none is named). It draws the built-in scenes, 512 x 512, in the generated Verilog: each as an
engine's second frame, once over nothing and once over its own picture, whose words are all loaded
and then leave again. It prints cycles, and what they are more than one for each code word, which no
engine takes less than. Splats are as large as the scene is spaced, times 0.7, 1 and 4/3.
"""

from __future__ import annotations

import sys

from splatline.contract.presets import PRESETS
from splatline.contract.variants import VARIANTS
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.scenes.scenes import SCENES
from splatline.sim import golden
from splatline.sim.cosim.player.frames import Job, play

ENGINES = PRESETS | {config.name: config for config in VARIANTS}

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
