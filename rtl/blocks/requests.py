"""The requests of the rows of lanes: what the window's arbitration granted, in registers."""

from amaranth.hdl import Cat, Mux, Signal

from .dirty_bits import residue_bits
from .lane_row import HALVES, row_address_bits

__all__ = ["register_load", "request_addresses", "request_pixels", "word_of"]


def request_pixels(m, window, requests, grants, again, behind, sweeping):
    """Request the block's pixels, the load and the flush of their rows of lanes.

    ``behind`` means nothing with planes.
    """
    block = window.i.payload
    for q, request in enumerate(requests):
        m.d.sync += [
            request.draw.eq(grants.going),
            request.mask.eq(block.mask[q]),
            request.odd.eq(block.odd[q]),
            request.again.eq(again),
            request.line.eq(block.lines[q]) if window.config.plane else request.behind.eq(behind),
            request.load.eq(grants.loading & grants.row_served[q]),
            request.clear.eq((grants.flushing & grants.row_served[q]) | sweeping),
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


def register_load(m, window, loaded, loader):
    """Split the loaded beat into its even and its odd word; background has colour 0."""
    pixels, count = loader.o.payload.pixels, window.config.pixels_per_word
    for half, name in enumerate(HALVES):
        word = getattr(loaded, name)
        for column in range(count):
            pixel = count * half + column
            depth, colour = pixels.depth[pixel], pixels.colour[pixel]
            m.d.sync += [
                word.depth[column].eq(depth),
                word.colour[column].eq(Mux(depth.all(), 0, colour)),
            ]


def word_of(block, half):
    """Return the number of a block's even or odd word among the even or odd words of its line.

    If the first of its two words is even, both numbers are the same.
    """
    return block.words[1 - half][1:]
