"""Packets on the AXI top that are no frames, and every kind of control word."""

import dataclasses

import numpy as np

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.sim import golden
from tests.rtl.bus.axi_cases import expected_errors
from tests.support import bus_words
from tests.support.random_frames import random_raster, word

from .bus_frames import SIZE, a_frame, answer, prepare
from .bus_script import Script
from .frames import (
    any_control,
    any_empty_row,
)

__all__ = ["any_packets", "control_words", "odd_packets", "odd_rasters"]


def odd_packets(config: EngineConfig, rng) -> Script:
    """Send packets with each error of its own."""
    script = Script(config)
    frame = a_frame(config, rng)
    words = frame.codewords
    width, height = SIZE
    prepare(script, frame)
    block, advance = bus_words.block(config, 9), bus_words.advance
    answer(script, frame, [*words[:20], bus_words.block(config, width), *words[20:]], ["X_OUTSIDE"])
    answer(script, frame, [bus_words.block(config, width - 1), *words], [])
    answer(script, frame, [bus_words.block(config, config.x.mask), *words], ["X_OUTSIDE"])
    for bit in range(6, config.x_bits):
        outside = bus_words.block(config, 1 << bit)
        answer(script, frame, [block, outside, words[-1]], ["X_OUTSIDE"])
    for bit in range(6, config.x_bits):
        answer(script, frame, [block, advance(config, 1 << bit), words[-1]], ["LINE_PAST"])
    for size in ((16, 16), (400, 16), (200, 300)):
        script.write("LAST_COLUMN", size[0] - 1)
        script.write("LAST_LINE", size[1] - 1)
        small = dataclasses.replace(frame, width=size[0], height=size[1])
        for x, step in ((size[0] - 1, size[1] + 3), (size[0], size[1] + 4)):
            sent = [bus_words.block(config, x), advance(config, step), words[-1]]
            wrong = ["X_OUTSIDE", "LINE_PAST"] if x == size[0] else []
            answer(script, small, sent, wrong)
    script.write("LAST_COLUMN", width - 1)
    script.write("LAST_LINE", height - 1)
    answer(script, frame, [block, advance(config, height + 3), block, words[-1]], [])
    answer(script, frame, [block, advance(config, height + 4), block, words[-1]], ["LINE_PAST"])
    answer(script, frame, [*[advance(config, config.x.mask)] * 9, *words], ["LINE_PAST"])
    answer(script, frame, words[:-1], ["FRAME_ENDED_EARLY"])
    answer(script, frame, [*words, *words[:9], *words], ["END_WITHOUT_LAST"], drawn=words)
    answer(script, frame, words, [])
    size = bus_words.word_bytes(config)
    for byte in range(size):
        keep = np.ones((len(words), size), np.uint8)
        keep[byte:-1:6, byte] = 0
        if byte == 5:
            keep[10:14] = 0
        answer(script, frame, words, ["PARTIAL_WORD"], keep=keep, drawn=words[keep.all(axis=1)])
    keep = np.zeros((3, size), np.uint8)
    answer(script, frame, words[:3], ["FRAME_ENDED_EARLY", "PARTIAL_WORD"], keep=keep, drawn=[])
    keep = np.ones((len(words), size), np.uint8)
    keep[-1, 4] = 0
    answer(script, frame, words, ["FRAME_ENDED_EARLY", "PARTIAL_WORD"], keep=keep)
    answer(script, frame, words[-1:], [])
    answer(script, frame, words, [])
    return script


def any_packets(config: EngineConfig, rng) -> Script:
    """Send packets of any words, sizes, ends and lengths."""
    script = Script(config)
    frame = a_frame(config, rng)
    prepare(script, frame)
    for _ in range(5):
        words = bus_words.any_words(rng, int(rng.integers(1, 60)), *SIZE, config)
        words[rng.random(len(words)) < rng.choice([0.0, 0.05, 0.5])] = bus_words.end(config)
        present = rng.integers(0, 2, (len(words), bus_words.word_bytes(config)))
        keep = np.where(rng.random((len(words), 1)) < 0.1, present, 1).astype(np.uint8)
        kept = words[keep.all(axis=1)]
        ends = bus_words.decoded(kept, config)["end"].astype(bool)
        taken = kept[: int(np.argmax(ends)) + 1] if ends.any() else kept
        names = expected_errors(words, keep, config)
        answer(script, frame, words, names, keep=keep, drawn=taken)
    return script


def control_words(config: EngineConfig, rng) -> Script:
    """Send words that are just no control words, and every kind of end word; count elements."""
    script = Script(config)
    frame = a_frame(config, rng)
    prepare(script, frame)
    script.write("CONTROL", script.bits("CONTROL", "CLEAR"))
    elements = 0
    row_of = [(row, first, last) for row in range(4) for first in range(8) for last in range(8)]
    for begin in range(0, len(row_of), 32):
        words = []
        for row, first, last in row_of[begin : begin + 32]:
            rows = [any_empty_row(rng) for _ in range(4)]
            rows[row] = first, last
            if first > last:
                words.append(any_control(rng, config, end=False))
            # An odd intensity: a control word with it ends the frame.
            depth = int(rng.integers(config.background_depth))
            words.append(
                word(rows, 5 * row, depth, mode=int(first <= last), diffuse=1, config=config)
            )
            elements += 1
        words.append(any_control(rng, config, end=True))
        answer(script, frame, np.array(words, np.uint64), [])
        script.read("ELEMENTS", elements)
    return script


def odd_rasters(config: EngineConfig, rng) -> Script:
    """Send initial rasters that end early or late, or lack a byte, or that no frame asked for."""
    script = Script(config)
    frame = a_frame(config, rng)
    start = random_raster(rng, *SIZE, 0.1, config)
    other = to_beats(random_raster(rng, *SIZE, 0.05, config))
    beats = to_beats(start)
    prepare(script, frame)
    script.packet("initial", beats)
    answer(script, frame, frame.codewords, [])
    script.write("START", 1)
    answer(script, frame, frame.codewords, [], start=start)
    script.packet("initial", beats[:-1])
    answer(script, frame, frame.codewords, ["INITIAL_ENDED_EARLY"], start=start)
    script.packet("initial", np.concatenate([beats, other]))
    script.packet("codewords", frame.codewords)
    script.picture(to_beats(golden.render(frame, start)))
    script.settle()
    script.sent("initial")
    script.wait(2)
    script.errors("INITIAL_WITHOUT_LAST")
    size = raster_stream_bytes(config)
    keep = np.ones((len(beats) + 1, size), np.uint8)
    keep[3, int(rng.integers(size))] = 0
    extra = np.insert(beats, 3, other[0], axis=0)
    script.packet("initial", extra, keep)
    answer(script, frame, frame.codewords, ["INITIAL_PARTIAL"], start=start)
    script.packet("initial", beats)
    answer(script, frame, frame.codewords, [], start=start)
    script.write("START", 0)
    return script
