"""The requests of the rows of lanes: what the window's arbitration granted, in registers."""

from amaranth.hdl import Cat, Mux, Signal
from amaranth.lib import data

from splatline.rtl.layouts import PixelLayout

from .dirty_bits import residue_bits
from .lane_row import HALVES, BeatWordsLayout, row_address_bits

__all__ = ["register_columns", "request_addresses", "request_pixels", "word_of"]


def request_pixels(m, window, requests, grants, again, behind, sweeping):
    """Request the block's pixels, the load and the flush of their rows of lanes.

    ``behind`` means nothing with planes.
    """
    block = window.i.payload
    served = grants.loading | grants.flushing
    for q, request in enumerate(requests):
        m.d.sync += [
            # As a load goes, other rows neither draw nor store.
            request.draw.eq(grants.going),
            request.mask.eq(Mux(grants.loading, -1, block.mask[q])),
            request.odd.eq(Mux(grants.loading, -1, block.odd[q])),
            request.again.eq(again),
            request.line.eq(block.lines[q]) if window.config.plane else request.behind.eq(behind),
            request.store.eq((served & grants.row_served[q]) | sweeping),
            request.clear.eq((grants.flushing & grants.row_served[q]) | sweeping),
            # The even word goes into both; the odd one follows.
            request.both.eq(grants.loading & ~grants.odd),
        ]


def request_addresses(m, window, requests, grants, clearing):
    """Set the rows' addresses: of the block's words, of the service, or of the clearing."""
    config = window.config
    block, service = window.i.payload, grants.service
    group = service.line[residue_bits(config) : config.slot_bits]
    place = Signal(row_address_bits(config))
    served = Cat(service.word[1:], group)
    m.d.comb += place.eq(Mux(clearing.sweeping, clearing.sweep, served))
    for half, name in enumerate(HALVES):
        m.d.sync += [
            getattr(request.addresses, name).eq(
                Mux(grants.busy[q], Cat(word_of(block, half), block.group[q]), place)
            )
            for q, request in enumerate(requests)
        ]


def register_columns(m, window, new, load, odd):
    """Return what the rows write in each column: the block's pixel, or that of the loaded word.

    ``new`` and ``load``: the block of the cycle before, or zeros if a word was loaded then; and the
    beat that is loaded in this cycle. ``odd``: the odd word of it is. Each is zeros if the other is
    not, so that a gate joins them. Background has colour 0. With planes the rows sum a block's
    depths.
    """
    config = window.config
    pixels, count = load.payload.pixels, config.pixels_per_word
    beat = Signal(BeatWordsLayout(config), name="loaded", reset_less=True)
    is_odd = Signal(name="loaded_odd", reset_less=True)
    columns = Signal(
        data.ArrayLayout(PixelLayout(config), count), name="new_columns", reset_less=True
    )
    m.d.sync += is_odd.eq(odd)
    for half, name in enumerate(HALVES):
        word = getattr(beat, name)
        for column in range(count):
            pixel = count * half + column
            depth, colour = pixels.depth[pixel], pixels.colour[pixel]
            m.d.sync += [
                word.depth[column].eq(Mux(load.valid, depth, 0)),
                word.colour[column].eq(Mux(load.valid, colour, 0)),
            ]
    for column, pixel in enumerate(columns):
        depth = Mux(is_odd, beat.odd.depth[column], beat.even.depth[column])
        colour = Mux(is_odd, beat.odd.colour[column], beat.even.colour[column])
        joined = Signal(config.depth_bits, name=f"joined_{column}")
        m.d.comb += joined.eq(depth if config.plane else depth | new.depth)
        m.d.sync += [
            pixel.depth.eq(joined),
            # A block of this depth is not drawn.
            pixel.colour.eq(Mux(joined.all(), 0, colour | new.colour)),
        ]
    return columns


def word_of(block, half):
    """Return the number of a block's even or odd word among the even or odd words of its line.

    If the first of its two words is even, both numbers are the same.
    """
    return block.words[1 - half][1:]
