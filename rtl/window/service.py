"""Service of a window: its loader, its flush scan, and the end of a frame."""

from typing import NamedTuple

from amaranth.hdl import Signal, Value

from splatline.rtl.layouts import PlaceLayout

__all__ = [
    "Clearing",
    "connect_flush_scan",
    "connect_frame_end",
    "connect_loader",
    "select_service",
]


class Clearing(NamedTuple):
    """The clearing of the lanes after reset.

    Parameters
    ----------
    sweeping
        An address of the lanes is cleared in this cycle.
    sweep
        That address.
    swept
        Pixels of this cycle or of cycles before are still to be cleared.
    """

    sweeping: Value
    sweep: Value
    swept: Value


def connect_loader(m, window, loader, oldest, close):
    """Pass the frame's size and state to the loader."""
    m.d.comb += [
        loader.enable.eq(window.load),
        loader.active.eq(window.active),
        loader.last_line.eq(window.last_line),
        loader.last_word.eq(window.last_column[window.config.pixel_bits :]),
        loader.oldest.eq(oldest),
        loader.restart.eq(close),
    ]


def connect_frame_end(m, window, flush_scan, readout, close, closes):
    """Close the frame if ``closes``; request its end beat once the flush scan is over."""
    ending = Signal()
    m.d.comb += [
        readout.end.eq(ending),
        window.finished.eq(readout.finished),
        close.eq(closes),
        flush_scan.close.eq(close),
        window.closing.eq(flush_scan.closing),
    ]
    m.d.sync += ending.eq(flush_scan.over & ~window.finished)


def select_service(m, window, flush, load, serving):
    """Return the word that is served: that of the load if ``serving``, else that of the flush."""
    service = Signal(PlaceLayout(window.config))
    m.d.comb += service.eq(flush)
    with m.If(serving):
        m.d.comb += [service.word.eq(load.word), service.line.eq(load.line)]
    return service


def connect_flush_scan(m, window, flush_scan, loader, enable, clearing):
    """Tell the flush scan which lines are loaded; clear all dirty bits after reset."""
    m.d.comb += [
        flush_scan.limit.eq(loader.limit),
        flush_scan.jump.eq(loader.finished),
        flush_scan.enable.eq(enable),
        flush_scan.wipe.eq(clearing.sweeping),
        flush_scan.wipe_row.eq(clearing.sweep),
        flush_scan.restart.eq(window.finished),
    ]
