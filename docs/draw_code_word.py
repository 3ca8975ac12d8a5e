"""Draw how an engine draws a code word: ``docs/pictures/code_word.svg``.

Run as ``.venv/bin/python docs/draw_code_word.py [FILE]``. The code word is one of a real frame. The
golden renderer tells the pixels before it and after it, and the drawing is checked against them.
"""

import sys
from pathlib import Path

import numpy as np
from animation import (
    BACKGROUND,
    EDGE,
    MUTED,
    TEXT,
    draw_first,
    keyframes,
    moves,
    rect,
    small_frame,
    svg,
    text,
)

from splatline.sim import golden

FIELDS = {
    "mode": ("MODE", 0, 1, "#f2c14e"), "scans": ("SCANS", 1, 24, "#4f9dde"),
    "diffuse": ("DIFFUSE", 25, 7, "#3fb978"), "specular": ("SPECULAR", 32, 7, "#8bd17c"),
    "material": ("MATERIAL", 39, 7, "#c78bd8"), "x": ("X", 46, 9, "#e8823d"),
    "z": ("Z", 55, 9, "#e0605e"),
}  # fmt: skip
"""Fields of a code word of ``paper`` and ``rgb24``: name, lowest bit, bits, colour."""

STEPS = (
    "A code word has 64 bits. X says where its block is, Z how deep.",
    "SCANS has four rows: a first and a last column each.",
    "MODE 0: the other four rows are the same, rotated by half a turn.",
    "The colour is computed once for the whole element.",
    "Cycle 1: the upper left tile of 4 x 4 pixels.",
    "Cycle 2: the upper right tile. Z must be less than the stored depth.",
    "Cycle 3: the lower left tile.",
    "Cycle 4: the lower right tile. The next code word follows.",
)
CELL = 24


def main(path):
    """Write the drawing."""
    frame = small_frame(90, quality="fast")
    index, before, after = choose(frame)
    word = int(frame.codewords[index])
    fields = golden.decode(frame.codewords[index : index + 1], frame.config)
    first, last = (ends[0] for ends in golden.block_rows(fields))
    line = line_of(frame, index)
    rules, parts = [], []
    for step in range(len(STEPS)):
        rules.append(keyframes(f"from{step}", [shown(now >= step) for now in range(len(STEPS))]))
        rules.append(keyframes(f"only{step}", [shown(now == step) for now in range(len(STEPS))]))
    parts += bits_panel(word, fields[0])
    parts += block_panel(first, last)
    parts += image_panel(
        before, after, first, last, int(fields["x"][0]), line - 4, int(fields["z"][0])
    )
    parts += colour_panel(frame, fields[0], after.colour[before.depth != after.depth][0])
    for step, words in enumerate(STEPS):
        parts.append(f"<g {moves(f'only{step}')}>{text(24, 452, words, size=15)}</g>")
    path.write_text(
        svg(760, 476, 24, 0.97, "An engine draws a code word", rules, parts), encoding="utf-8"
    )


def shown(whether):
    """Return the value of an animation that shows an element, or hides it."""
    return f"opacity:{int(whether)}"


def line_of(frame, index):
    """Return the engine's current line at a code word."""
    fields = golden.decode(frame.codewords[:index], frame.config)
    return int(fields["x"][fields["control"]].astype(int).sum())


def choose(frame):
    """Return the first element with all kinds of pixels, and the picture before and after it.

    It is a symmetric word about a corner of pixels, of six rows or more. Some of its pixels are
    behind what is drawn there, some before it, and some before the background.
    """
    fields = golden.decode(frame.codewords, frame.config)
    plain = (fields["mode"] == 0) & ~fields["raised"] & ~fields["shifted"] & ~fields["control"]
    first, last = golden.block_rows(fields)
    whole = plain & ((first <= last).sum(axis=1) >= 6)
    for index in np.flatnonzero(whole):
        before, after = draw_first(frame, index), draw_first(frame, index + 1)
        inside = covered(
            first[index], last[index], int(fields["x"][index]), line_of(frame, index) - 4, before
        )
        drawn = (before.depth != after.depth) & inside
        kept, over = inside & ~drawn, drawn & before.drawn
        if kept.sum() >= 5 and over.sum() >= 5 and (drawn & ~before.drawn).sum() >= 5:
            return index, before, after
    raise SystemExit("draw_code_word: no element has all kinds of pixels")


def covered(first, last, x, top, raster):
    """Return which pixels of the image an element covers: (lines, columns), bool."""
    inside = np.zeros(raster.depth.shape, np.bool_)
    for row in range(8):
        if first[row] <= last[row] and 0 <= top + row < len(inside):
            inside[top + row, x + first[row] : x + last[row] + 1] = True
    return inside


def bits_panel(word, fields):
    """Return the 64 bits, coloured by field, with the fields' values."""
    parts, pitch = [text(24, 34, "A code word", size=16)], 11.1
    for name, (title, lsb, width, colour) in FIELDS.items():
        for bit in range(lsb, lsb + width):
            x = 24 + pitch * (63 - bit)
            parts.append(rect(x, 48, pitch - 1.5, 20, fill=colour, extra='rx="1.5"'))
            digit = text(x + (pitch - 1.5) / 2, 62, word >> bit & 1, size=10, fill="#10151c",
                         anchor="middle", extra='class="mono"')  # fmt: skip
            parts.append(digit)
        middle = 24 + pitch * (63.5 - lsb - (width - 1) / 2)
        value = "" if name == "scans" else f" {fields[name]}"
        label = "MODE 0" if name == "mode" else title + value
        end = "end" if name == "mode" else "middle"
        parts.append(
            text(middle + (6 if name == "mode" else 0), 84, label, size=11, fill=colour, anchor=end)
        )
    return parts


def block_panel(first, last):
    """Return the block of 8 x 8 pixels: four rows as sent, four rotated."""
    x, y = 24, 128
    parts = [text(x, 116, "Its block of 8 x 8 pixels", size=14)]
    for row in range(8):
        step, colour = (1, FIELDS["scans"][3]) if row < 4 else (2, FIELDS["mode"][3])
        top = y + CELL * row
        parts.append(rect(x, top, 8 * CELL, CELL, stroke=EDGE))
        label = "" if first[row] > last[row] else f"{first[row]}..{last[row]}"
        cells = [
            rect(x + CELL * column + 1, top + 1, CELL - 2, CELL - 2, fill=colour, extra='rx="2"')
            for column in range(first[row], last[row] + 1)
        ]
        label = text(x + 8 * CELL + 8, top + 16, label or "empty", size=11, fill=MUTED)
        parts.append(f"<g {moves(f'from{step}')}>{''.join(cells)}{label}</g>")
    parts += [rect(x + CELL * column, y, CELL, 8 * CELL, stroke=EDGE) for column in range(8)]
    return parts


def image_panel(before, after, first, last, x, top, z):
    """Return a part of the image with its depths; tile by tile the element is drawn into it."""
    left, high, columns, lines = x - 2, top - 1, 12, 10
    place_x, place_y = 448, 128
    parts = [text(place_x, 116, "The window, with the depth of each pixel", size=14)]
    inside = covered(first, last, x, top, before)
    for line in range(high, high + lines):
        for column in range(left, left + columns):
            at = (place_x + CELL * (column - left), place_y + CELL * (line - high))
            parts.append(pixel(at, before, line, column))
            if not inside[line, column]:
                continue
            step = 4 + (column - x) // 4 + 2 * ((line - top) // 4)
            drawn = z < before.depth[line, column]
            assert after.depth[line, column] == (z if drawn else before.depth[line, column])
            if drawn:
                ring = rect(
                    at[0] + 1, at[1] + 1, CELL - 3, CELL - 3, stroke="#ffffff", extra='rx="2"'
                )
                changed = pixel(at, after, line, column) + ring
            else:
                changed = rect(at[0] + 1, at[1] + 1, CELL - 3, CELL - 3, stroke=FIELDS["z"][3],
                               extra='rx="2" stroke-width="2" stroke-dasharray="3 2"')  # fmt: skip
            parts.append(f"<g {moves(f'from{step}')}>{changed}</g>")
    for step in range(4, 8):
        tile_x = place_x + CELL * (x - left + 4 * ((step - 4) % 2))
        tile_y = place_y + CELL * (top - high + 4 * ((step - 4) // 2))
        outline = rect(
            tile_x, tile_y, 4 * CELL, 4 * CELL, stroke=FIELDS["mode"][3], extra='stroke-width="2.5"'
        )
        parts.append(f"<g {moves(f'only{step}')}>{outline}</g>")
    parts += [
        rect(place_x, 378, 11, 11, stroke="#ffffff", extra='rx="2"'),
        text(place_x + 18, 388, f"nearer, Z {z}: written", size=12, fill=MUTED),
        rect(
            place_x + 166, 378, 11, 11, stroke=FIELDS["z"][3], extra='rx="2" stroke-dasharray="3 2"'
        ),
        text(place_x + 184, 388, "behind: stays", size=12, fill=MUTED),
    ]
    return parts


def pixel(at, raster, line, column):
    """Return a pixel of the image with its colour and depth."""
    drawn = raster.drawn[line, column]
    colour = raster.colour[line, column] if drawn else BACKGROUND
    light = np.dot(colour, (0.3, 0.6, 0.1)) > 110
    ink = "#10151c" if light else TEXT if drawn else "#5b6877"
    label = raster.depth[line, column] if drawn else "·"
    x, y = at
    number = text(
        x + CELL / 2, y + 16, label, size=9.5, fill=ink, anchor="middle", extra='class="mono"'
    )
    fill = f"rgb({','.join(str(int(part)) for part in colour)})"
    return rect(x, y, CELL - 1, CELL - 1, fill=fill) + number


def colour_panel(frame, fields, drawn):
    """Return how the element's colour is computed, with its numbers."""
    tables, config = frame.tables, frame.config
    material, d, s = (int(fields[name]) for name in ("material", "diffuse", "specular"))
    parts = [text(24, 352, "Its colour: I0 + (kd D + ks S) / 256", size=14)]
    for channel, name in enumerate(("red", "green", "blue")):
        ambient = int(tables.ambient[channel])
        kd, ks = int(tables.diffuse[material, channel]), int(tables.specular[material, channel])
        value = min((ambient + kd * d + ks * s) >> config.colour_shift, 255)
        assert value == drawn[channel]  # the drawing shows what golden did
        words = f"{name:5}  {ambient / 256:.1f} + ({kd} x {d} + {ks} x {s}) / 256 = {value}"
        parts.append(
            text(
                24,
                372 + 18 * channel,
                words,
                size=12,
                fill=MUTED,
                extra='class="mono" xml:space="preserve"',
            )
        )
    return [f"<g {moves('from3')}>{''.join(parts)}</g>"]


if __name__ == "__main__":
    main(
        Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "pictures/code_word.svg")
    )
