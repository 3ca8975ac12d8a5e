"""Simulates the tops with streams of their own: engine, chain and narrow top.

Each function returns the rows of a frame, as :func:`port_traces.trace` does.
"""

from functools import cache

from port_traces import signals, stream_feed, stream_sink, top_taken, trace
from port_words import CLEARED, CONFIG, beat_label, elements, initial_beats, table_writes

from splatline.rtl.bus.narrow_top import BEAT_PIECE, WORD_PIECE, PinTop
from splatline.rtl.chain.chain import Chain
from splatline.rtl.engine import Engine

__all__ = ["chain_rows", "engine_rows", "initial_rows", "narrow_initial_rows", "narrow_rows"]


@cache
def engine_rows(start):
    """Return a frame that is offered from a cycle on, and a table write that waits for its end."""
    top = Engine(CONFIG)
    writes = [*table_writes(), ("next frame's", table_writes()[-1][1])]
    parts = [
        stream_feed(top, "tables", writes,
                    when=lambda rows: len(top_taken(rows, "tables")) < 4
                    or len(top_taken(rows, "codewords")) > 2),
        stream_feed(top, "codewords", elements(3),
                    when=lambda rows: len(rows) >= start),
        stream_sink(top, "raster", beat_label, waits=lambda cycle: cycle % 5 in (1, 2)),
    ]  # fmt: skip
    return trace(top, parts, signals(top, "tables", "codewords", "raster") | {
        "in_frame": top.in_frame}, CONFIG.clear_cycles + 200)  # fmt: skip


@cache
def initial_rows():
    """Return the start of a frame that begins with a raster."""
    top = Engine(CONFIG)
    parts = [
        stream_feed(top, "tables", table_writes(load=1)),
        stream_feed(top, "codewords", elements(1),
                    when=lambda rows: len(rows) >= CLEARED),
        stream_feed(top, "initial", initial_beats(), when=lambda rows: len(rows) > 5),
        stream_sink(top, "raster", beat_label),
    ]  # fmt: skip
    ports = signals(top, "codewords", "initial", "raster")
    return trace(top, parts, ports, CONFIG.clear_cycles + 200)


def pieces(words, size, count, mark=0):
    """Return the pieces of words, the lowest first; the first one has the word's label."""
    return [
        (str(n) if n else label, word >> size * n & (1 << size) - 1 | mark << size)
        for label, word in words
        for n in range(count)
    ]


@cache
def narrow_rows():
    """Return a frame on the narrow top."""
    top = PinTop(CONFIG)
    words = [
        *pieces(table_writes(), WORD_PIECE, 4, mark=1),
        *pieces(elements(0), WORD_PIECE, 4),
    ]
    parts = [
        stream_feed(top, "words", words),
        stream_sink(top, "raster", lambda piece: f"{piece:x}"),
    ]
    ports = signals(top, "words", "raster") | {"words.table": top.words.payload.table}
    return trace(top, parts, ports, CONFIG.clear_cycles + 300)


@cache
def narrow_initial_rows():
    """Return the start of a frame on the narrow top that begins with a raster."""
    top = PinTop(CONFIG)
    words = [
        *pieces(table_writes(load=1), WORD_PIECE, 4, mark=1),
        *pieces(elements(0), WORD_PIECE, 4),
    ]
    beats = pieces(initial_beats(), BEAT_PIECE, 5)
    parts = [
        stream_feed(top, "words", words, when=lambda rows: len(rows) >= CLEARED),
        stream_feed(top, "initial", beats, when=lambda rows: len(rows) > CLEARED + 5),
        stream_sink(top, "raster", lambda piece: f"{piece:x}"),
    ]
    ports = signals(top, "words", "initial") | {"words.table": top.words.payload.table}
    return trace(top, parts, ports, CONFIG.clear_cycles + 85)


@cache
def chain_rows():
    """Return a frame of two engines that begins with a raster, and the next frame's table write.

    The second engine's part is offered later.
    """
    top = Chain(CONFIG, 2)
    writes = [*table_writes(load=1), ("next frame's", table_writes()[-1][1])]
    parts = [
        stream_feed(top, "tables", writes,
                    when=lambda rows: len(top_taken(rows, "tables")) < 4
                    or len(top_taken(rows, "codewords_1")) > 1),
        stream_feed(top, "codewords_0", elements(1), when=lambda rows: len(rows) >= CLEARED),
        stream_feed(top, "codewords_1", elements(0), when=lambda rows: len(rows) >= CLEARED + 4),
        stream_feed(top, "initial", initial_beats(), when=lambda rows: len(rows) >= CLEARED + 2),
        stream_sink(top, "raster", beat_label, waits=lambda cycle: cycle % 5 in (1, 2)),
    ]  # fmt: skip
    ports = signals(top, "tables", "codewords_0", "codewords_1", "initial", "raster")
    return trace(top, parts, ports, CONFIG.clear_cycles + 165)
