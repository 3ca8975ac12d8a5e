"""Measure the bits that are sent for elements: plain, compact and hypothetical shorter code words.

Run as ``.venv/bin/python docs/measure_compact.py``. It encodes the built-in scenes with splats of
several sizes and the quality ``paper``. It prints a table of bits for three kinds of code words:
plain ones, compact ones of 64 bits, and compact ones of 57 bits. The latter have size 5, n' 12, D
7, S 7, material 7, x 9, z 9 and one bit that tells them from other code words, which then have 65.
The table also has the number of pieces of 16 bits, in which the narrow top takes code words.
"""

import numpy as np

from splatline.contract.config import COMPACT
from splatline.contract.variants import SHAPED
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.scenes.scenes import SCENES

FACTORS = (1, 2, 4, 6)
SHORT, WORD, PIECE = 57, 64, 16


def count(frame):
    """Return the numbers of compact and of other code words of a frame."""
    config = frame.config

    def take(field):
        return frame.codewords >> np.uint64(field.lsb) & np.uint64(field.mask)

    is_compact = (take(config.mode) == 0) & (take(config.compact_mark) == COMPACT)
    return int(is_compact.sum()), int((~is_compact).sum())


def main():
    """Print the table."""
    full = SHAPED[-1]
    print("| scene | splats | with shapes | compact, 64 | 57 bits | less | pieces, 64 | 57 |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for name in SCENES:
        scene = load_scene(name)
        view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up)
        for factor in FACTORS:
            radii = factor * splat_radii(scene.cloud)
            options = {"radii": radii, "quality": "paper", "config": full}
            table = make_frame(scene.cloud, view, **options)
            compact, others = count(make_frame(scene.cloud, view, shapes="rom", **options))
            plain = WORD * len(table.codewords)
            long = WORD * (compact + others)
            short = SHORT * compact + (WORD + 1) * others
            pieces = [
                compact * -(-bits // PIECE) + others * -(-(WORD + flag) // PIECE)
                for bits, flag in ((WORD, 0), (SHORT, 1))
            ]
            print(
                f"| {name} | x {factor} | {plain:,} | {long:,} | {short:,} |"
                f" {1 - short / long:.1%} | {pieces[0]:,} | {pieces[1]:,} |"
            )


if __name__ == "__main__":
    main()
