"""Draw how the window slides down the image: ``docs/pictures/window.svg``.

Run as ``.venv/bin/python docs/draw_window.py [FILE]``. The cycle model tells where the window is in
each cycle, and the golden renderer what is drawn by then. So the drawing shows the machine.
"""

import sys
from pathlib import Path

import numpy as np
from animation import (
    EDGE,
    MUTED,
    draw_first,
    keyframes,
    moves,
    pixels_of,
    png,
    rect,
    small_frame,
    svg,
    text,
)

from splatline.sim import golden
from splatline.sim.cycles.window_trace import trace_window

STEPS = 110
"""Moments that are shown."""

HOLD = 0.12
LINES = 16
PANEL_GREY = (16, 21, 28)
"""Where no line of the image is."""

STATES = {
    "waits to leave": (232, 163, 61),
    "is drawn into": (63, 185, 120),
    "to come": (88, 102, 120),
}
"""States of a line of the window, each with its colour."""


def main(path):
    """Write the drawing."""
    frame = small_frame(20)
    trace = trace_window(frame)
    shown = np.linspace(0, len(trace.top) - 3, STEPS).astype(int)
    past = frame.height + 4  # beyond it nothing is drawn, and the window need not move on
    top, oldest = np.minimum(trace.top[shown], past), np.minimum(trace.oldest[shown], past)
    pictures = [pixels_of(draw_first(frame, max(index, 0))) for index in trace.element[shown]]
    final = pixels_of(golden.render(frame))
    lines, slots = [], []
    for picture, first, bottom in zip(pictures, oldest, top, strict=True):
        strip = window_lines(picture, first, bottom)
        lines.append(strip)
        slots.append(np.roll(strip, first % LINES, axis=0))
    rules, parts = image_panel(final, np.concatenate(lines), oldest)
    more_rules, more = memory_panel(np.concatenate(slots), oldest)
    cycles = [f"cycle {cycle:,}" for cycle in shown]
    rules += more_rules
    parts += more + counter(cycles, trace, frame) + legend()
    drawing = svg(760, 452, 16, 0.4, "The window slides down the image", rules, parts)
    path.write_text(drawing, encoding="utf-8")


def window_lines(picture, first, top):
    """Return the window's 16 lines, with the state of each in three further columns."""
    height, width, _ = picture.shape
    strip = np.zeros((LINES, width + 4, 3), np.uint8)
    strip[:] = PANEL_GREY
    numbers = first + np.arange(LINES)
    inside = (numbers >= 0) & (numbers < height)
    strip[inside, :width] = picture[numbers[inside]]
    waits, drawn, to_come = STATES.values()
    state = np.where(
        (numbers < top)[:, np.newaxis],
        waits,
        np.where((numbers < top + 8)[:, np.newaxis], drawn, to_come),
    )
    strip[inside, width + 1 :] = state[inside, np.newaxis]
    return strip


def sprite(x, y, width, height, strip, name):
    """Return a part of a strip of pictures: the animation ``name`` moves it by 16 lines a step."""
    count, columns, _ = strip.shape
    return (
        f'<svg x="{x}" y="{y}" width="{width:g}" height="{height:g}" '
        f'viewBox="0 0 {columns} {LINES}" preserveAspectRatio="none">'
        f'<image href="{png(strip)}" width="{columns}" height="{count}" '
        f'preserveAspectRatio="none" {moves(name)}/></svg>'
    )


def image_panel(final, strip, oldest):
    """Return rules and parts of the image: what has left, and the window upon it."""
    scale, x, y = 3.5, 24, 64
    side = 96 * scale
    tall = LINES * scale
    step = [f"transform:translateY({-LINES * index}px)" for index in range(STEPS)]
    window = [f"transform:translateY({scale * line:g}px)" for line in oldest]
    left = [f"transform:scaleY({max(line, 0) / 96:.4f})" for line in oldest]
    rules = [
        keyframes("step", step, HOLD),
        keyframes("window", window, HOLD),
        keyframes("left", left, HOLD),
    ]
    parts = [
        text(x, 34, "The image", size=16),
        text(x, 54, "above the window: sent to the raster", fill=MUTED),
        rect(x, y, side, side, fill="#0b0f14", stroke=EDGE),
        '<clipPath id="sent"><rect x="0" y="0" width="96" height="96" '
        f"{moves('left')}/></clipPath>",
        f'<svg x="{x}" y="{y}" width="{side:g}" height="{side:g}" viewBox="0 0 96 96">'
        f'<g clip-path="url(#sent)"><image href="{png(final)}" width="96" height="96"/></g></svg>',
        f'<svg x="{x}" y="{y}" width="{side + 20:g}" height="{side:g}"><g {moves("window")}>',
        sprite(0, 0, 100 * scale, tall, strip, "step"),
        rect(0, 0, side, tall, stroke="#e6edf3", extra='stroke-width="2"'),
        "</g></svg>",
    ]
    return rules, parts


def memory_panel(strip, oldest):
    """Return rules and parts of the memory: line n in slot n modulo 16."""
    x, y, width, pitch = 452, 64, 250, 21
    parts = [
        text(x, 34, "The window in block RAM", size=16),
        text(x, 54, "line n of the image is in slot n mod 16", fill=MUTED),
        sprite(x, y, width, LINES * pitch, strip, "step"),
    ]
    rules = []
    for slot in range(LINES):
        height = y + slot * pitch
        parts.append(rect(x, height, width * 0.96, pitch, stroke=EDGE))
        parts.append(text(x - 8, height + 15, f"{slot}", size=11, fill=MUTED, anchor="end"))
        held = oldest + (slot - oldest) % LINES
        distinct = list(dict.fromkeys(held.tolist()))
        moved = [f"transform:translateY({-pitch * distinct.index(line)}px)" for line in held]
        rules.append(keyframes(f"line{slot}", moved, HOLD))
        names = "".join(
            text(0, 15 + pitch * index, f"{line}" if 0 <= line < 96 else "-", size=11)
            for index, line in enumerate(distinct)
        )
        parts.append(
            f'<svg x="{x + width + 8}" y="{height}" width="40" height="{pitch}">'
            f"<g {moves(f'line{slot}')}>{names}</g></svg>"
        )
    return rules, parts


def counter(cycles, trace, frame):
    """Return the clock, and how much the whole frame takes."""
    words = "".join(
        text(0, 14 + 20 * index, word, extra='class="mono"') for index, word in enumerate(cycles)
    )
    elements = int(np.sum(~golden.decode(frame.codewords, frame.config)["control"]))
    ticks = [f"transform:translateY({-20 * index}px)" for index in range(len(cycles))]
    return [
        f"<style>{keyframes('clock', ticks, HOLD)}</style>",
        f'<svg x="24" y="414" width="120" height="20"><g {moves("clock")}>{words}</g></svg>',
        text(130, 428, f"of {len(trace.top):,} for {elements:,} elements", fill=MUTED),
    ]


def legend():
    """Return the meaning of the colours beside the lines."""
    parts = []
    for index, (meaning, colour) in enumerate(STATES.items()):
        x = 452 + 110 * index
        parts.append(rect(x, 418, 11, 11, fill=f"rgb{colour}"))
        parts.append(text(x + 17, 428, meaning, size=12, fill=MUTED))
    return parts


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "pictures/window.svg"))
