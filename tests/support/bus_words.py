"""Code words as they are sent to an engine with planes or without: rows of limbs, or numbers.

A row is what a frame's array of code words holds of one: a number, or two halves of a plane word.
"""

import dataclasses

import numpy as np

from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.sim import golden
from tests.support import plane_words as pw
from tests.support.random_frames import nonsense, random_tables, shapes, word

__all__ = ["advance", "any_words", "block", "clean", "decoded", "end", "inside", "word_bytes"]


def word_bytes(config):
    """Return the bytes of a code word on its stream, as docs/contract.md says."""
    return 16 if config.plane else 8


def _row(value, config):
    """Return a Python integer as a row."""
    return pw.array_of([value])[0] if config.plane else value


def block(config, x):
    """Return an element of 8 x 8 pixels."""
    if config.plane:
        return _row(pw.encode([(0, 7)] * 4, mode=0, x=x, z=2, config=config), config)
    return word([(0, 7)] * 4, x, 1, mode=0, config=config)


def advance(config, lines):
    """Return the control word that advances the line, with ones in what means nothing."""
    if not config.plane:
        return advance_word(lines, config)
    return _row(pw.advance(lines, config) | _meaningless(config), config)


def end(config):
    """Return the control word that ends a frame, with ones in what means nothing."""
    if not config.plane:
        return end_word(config)
    return _row(pw.end(config) | _meaningless(config), config)


def _meaningless(config):
    """Return the mask of the bits of a plane word that mean nothing if it is a control word."""
    lsb, width = pw.widths(config)["x"]
    # MODE, SCANS, the bit that ends, and X.
    return (1 << 96) - 1 & ~((1 << 26) - 1 | (1 << width) - 1 << lsb)


def decoded(codewords, config):
    """Return for each code word whether it is a control word or an end word, and its X.

    Shape (n,), with the fields ``control``, ``end`` and ``x``.
    """
    if not config.plane:
        return golden.decode(codewords, config)[["control", "end", "x"]]
    lsb, width = pw.widths(config)["x"]
    rows = [
        (
            pw.is_control(each),
            pw.is_control(each) and each >> 25 & 1,
            each >> lsb & (1 << width) - 1,
        )
        for each in pw.integers_of(codewords)
    ]
    return np.array(rows, [("control", bool), ("end", bool), ("x", np.int64)])


def any_words(rng, count, width, height, config):
    """Return random code words, of which none ends a frame and some advance the line."""
    if not config.plane:
        return nonsense(rng, count, width, height, config=config).codewords[:-1]
    words = [pw.random_word(rng, (width, height), config) for _ in range(count)]
    for n in np.flatnonzero(rng.random(count) < 0.05):
        words[n] = _step(rng, int(rng.integers(0, 12)), config)
    codewords = pw.array_of([each & ~(pw.is_control(each) << 25) for each in words])
    # On the stream the bits above it mean nothing.
    codewords[:, 1] |= rng.integers(0, 1 << 32, count, np.uint64) << np.uint64(32)
    return codewords


def _step(rng, lines, config):
    """Return a plane word that advances the line, with anything in the bits that mean nothing."""
    garbage = int.from_bytes(rng.bytes(12), "little")
    return pw.advance(lines, config) | garbage & _meaningless(config)


def inside(codewords, width, config):
    """Return code words without the elements that lie beyond the last column."""
    fields = decoded(codewords, config)
    return codewords[fields["control"] | (fields["x"] < width)]


def clean(config, seed, count, width, height):
    """Return a frame that is sorted by line, with all elements in the image's columns."""
    rng = np.random.default_rng(seed)
    frame = (_planes if config.plane else shapes)(rng, count, width, height, config=config)
    return dataclasses.replace(frame, codewords=inside(frame.codewords, width, config))


def _planes(rng, count, width, height, config):
    """Return a frame of plane words with any shape, look, depth and slopes, sorted by line."""
    words, before = [], 0
    for line in np.sort(rng.integers(0, height + 4, count)).tolist():
        if line > before:
            words.append(_step(rng, line - before, config))
            before = line
        element = pw.random_word(rng, (width, height), config)
        words.append(element if not pw.is_control(element) else element & ~1)
    return pw.make_frame(words, (width, height), random_tables(rng, config), config)
