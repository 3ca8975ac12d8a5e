"""Properties of the window of tiles, and what those of blocks have in common with them."""

from amaranth.hdl import Cat, Const, Mux, Signal, signed

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.window import TileWindow
from tests.formal.followed_pixel import FollowedPixel
from tests.formal.properties import OneWord, any_constant, parts

__all__ = ["Narrow", "TileWindowProperties"]


class Narrow(EngineConfig):
    """An engine whose code word need not have 64 bits: only its window is looked at."""

    def __post_init__(self):
        """Check nothing."""


class TileWindowProperties(FollowedPixel):
    """Any one pixel of any one place in the window, followed from line to line.

    Of the tiles only what :class:`TileLayout` says is assumed, which ``tiles_tiler_proof`` proves.
    A colour says what depth it belongs to, so that they cannot part.

    Parameters
    ----------
    load
        1: frames start from an initial raster; 0: they do not.
    ordered
        The initial raster comes in order. If not, what is out of order may be dropped.
    """

    delay = 3
    """Cycles in which the raster is taken, from a pixel's line losing its place to its beat."""

    window = TileWindow
    flush_scan = TileFlushScan
    """What is proven, and what in it says which lines leave."""

    def __init__(self, config, load, ordered=True):
        self.config = config
        self.load = load
        self.ordered = ordered

    def describe(self, m):
        """Add the window and its properties."""
        config = self.config
        self.slot = any_constant(m, config.slot_bits, "slot")
        self.word = any_constant(m, config.word_bits, "word")
        self.number = any_constant(m, config.pixel_bits, "number")
        self.last_column = any_constant(m, config.x_bits, "last_column")
        self.last_line = any_constant(m, config.line_bits, "last_line")
        self.last_word = self.last_column[config.pixel_bits :]
        self.memories = self._memories(m)
        self.dut = dut = self.window(config)
        fragment = self.add(m, dut)
        self.drawn_depth = Signal(config.depth_bits)  # that a tile draws the pixel with
        self.free(
            m,
            dut,
            last_column=self.last_column,
            last_line=self.last_line,
            load=Signal(init=self.load, reset_less=True, name="load"),
            shade=self.drawn_depth,
        )
        m.d.comb += self.drawn_depth.eq(self._drawn_depth(dut.i.payload))
        (flush_scan,) = parts(fragment, self.flush_scan)
        self._own(m, flush_scan.oldest, flush_scan.front)
        self._mark(m, flush_scan)
        drawn = self._tiles(m)
        loaded = self._initial(m)
        self._follow(m, drawn, loaded)

    def _drawn_depth(self, tile):
        """Return the depth of the pixel in a tile; with planes that of its lane."""
        return tile.depth[self.slot[:2]][self.number] if self.config.plane else tile.z

    def _memories(self, m):
        """Return what the lanes' memories are: the pixel's word, which is background."""
        address = Signal(self.config.group_bits + self.config.word_bits)
        m.d.comb += address.eq(Cat(self.word, self.slot[2:]))
        return OneWord(address, init=-1)

    def _mark(self, m, flush_scan):
        """Assert that nothing is loaded while dirty bits are taken, as the flush scan assumes."""
        self.always(m, "markable", ~(flush_scan.taking & flush_scan.load.any()))

    def _second(self, tile, row, column):
        """Return whether a pixel of a tile lies in the second of its words."""
        return tile.next.bit_select(column, 1)

    def _own(self, m, oldest, front):
        """Say which line has the place at the moment: of the frame drawn, or of that which leaves.

        ``front`` is the window's first line in the one, ``oldest`` in the other.
        """
        config, dut = self.config, self.dut
        place = Signal(config.slot_bits)
        line = Signal(signed(config.line_bits + 3))
        self.is_drawn = Signal()  # it is of the frame that is drawn
        self.front = front
        self.line = Signal(config.line_bits + 2)
        self.close = Signal()
        self.frame = Signal()  # that is drawn, by turns 0 and 1
        self.owner = Signal()  # whose line it is
        m.d.comb += [
            place.eq(self.slot - front),
            line.eq(front + place),
            self.is_drawn.eq(line >= 0),
            self.line.eq(Mux(self.is_drawn, line, oldest + place)),
            self.close.eq(dut.i.valid & dut.i.ready & dut.i.payload.end),
            self.owner.eq(self.frame ^ ~self.is_drawn),
        ]
        m.d.sync += self.frame.eq(self.frame ^ self.close)
        self.always(m, "front", (front == oldest) | (dut.closing & (front < 0)))
        # What elements are let in by: with an initial raster the window as far as it was loaded,
        # which has at most the window's lines, and goes back only before the frame.
        before, ended = Signal.like(dut.oldest, name="oldest_once"), Signal(init=1)
        # None of its lines were loaded if it lies here, or above.
        none = (config.window_lines > BLOCK) - config.window_lines
        m.d.sync += [before.eq(dut.oldest), ended.eq(self.close)]
        self.always(m, "loaded_lines", (dut.oldest <= front) | (dut.oldest <= none))
        self.always(m, "goes_on", ended | (before <= dut.oldest) | (before <= none))

    def _tiles(self, m):
        """Assume of the tiles what they are; return whether one draws the pixel now."""
        config, dut = self.config, self.dut
        tile = dut.i.payload
        taken = dut.i.valid & dut.i.ready
        top = Signal.like(tile.top, name="top_before", init=-4)
        opened, closed = Signal(), Signal()
        lowest = (1 << len(tile.top) - 1) - 1
        oldest = Signal.like(dut.oldest, name="oldest_before")
        m.d.sync += [oldest.eq(dut.oldest), closed.eq(self.close)]
        m.d.sync += [top.eq(tile.top), opened.eq(dut.active)]
        with m.If(self.close):
            m.d.sync += [top.eq(-4), opened.eq(0)]
        self.given(m, "tiles_steady", self.steady(m, dut.i, "i"))
        self.given(m, "sorted", tile.top >= top)
        # A tile of the next frame does not come at once: its lines are in no window as yet.
        self.given(m, "behind_the_end", ~(closed & dut.i.valid) | tile.end)
        self.given(m, "end_top", ~dut.i.valid | ~tile.end | (tile.top == lowest))
        self.given(m, "active", (dut.active >= opened) & (dut.active >= dut.i.valid))
        self.given(m, "words", tile.words[1] == (tile.words[0] + 1)[: config.word_bits])
        rows = range(config.tile_lines)
        bits = config.slot_bits - config.group_bits
        for row in rows:
            # The line of the window that the tile's row is.
            place = Signal(config.slot_bits, name=f"place_{row}")
            line = Signal(signed(config.line_bits + 3), name=f"line_{row}")
            m.d.comb += [
                place.eq(Cat(Const(row, bits), tile.group[row]) - tile.top),
                line.eq(tile.top + place),
            ]
            masked = dut.i.valid & tile.mask[row].any()
            own = (line >= tile.top) & (line < tile.top + 8)
            inside = (line >= 0) & (line <= self.last_line)
            self.given(m, f"row_{row}", ~masked | (own & inside & ~tile.end))
            self.given(m, f"settled_{row}", ~masked | self._settled(line, oldest))
            for column in range(config.pixels_per_word):
                masked = dut.i.valid & tile.mask[row][column]
                word = tile.words[self._second(tile, row, column)]
                self.given(m, f"pixel_{row}_{column}", ~masked | (word <= self.last_word))
        # So the window may not move past a tile that waits.
        waits = ~dut.i.valid | tile.end | (tile.top < 0)
        self.always(m, "waits", waits | ((dut.oldest <= tile.top) & (self.front <= tile.top)))

        def mine(row):
            """Return whether the tile draws the pixel, if that is in a row of lanes."""
            return (
                (self.slot == Cat(Const(row, bits), tile.group[row]))
                & tile.mask[row].bit_select(self.number, 1)
                & (tile.words[self._second(tile, row, self.number)] == self.word)
            )

        draws = Signal()
        m.d.comb += draws.eq(dut.i.valid & ~tile.end & Cat(mine(row) for row in rows).any())
        drew = Signal()
        m.d.sync += drew.eq(taken & draws)
        self._meet(m, tile, drew & draws)
        return taken & draws

    def _settled(self, line, oldest):
        """Return whether a tile's line was there a cycle before.

        Of a higher window that is loaded, not as the last one.
        """
        lines = self.config.window_lines - self.load * (self.config.window_lines > BLOCK)
        return line < oldest + lines

    def _meet(self, m, tile, both):
        """Assume that a tile says so where it draws the pixel that was drawn a cycle before."""
        self.given(m, "meets", ~both | tile.meets)

    def _initial(self, m):
        """Assume of the initial raster what it is; return whether the pixel is loaded now."""
        config, dut = self.config, self.dut
        initial, beat = dut.initial, dut.initial.payload
        beat_bits = config.raster_pixels.bit_length() - 1
        self.given(m, "initial_steady", self.steady(m, initial, "initial"))
        for n in range(config.raster_pixels):
            depth, colour = beat.pixels.depth[n], beat.pixels.colour[n]
            blank = depth == config.background_depth
            self.given(m, f"colour_{n}", colour == Mux(blank, 0, depth))
        if self.ordered:
            place, last = Signal(config.line_bits + config.word_bits + 1), Signal(16)
            m.d.comb += place.eq(Cat(beat.word, beat.line) + 1)
            with m.If(initial.valid & initial.ready):
                m.d.sync += last.eq(place)
            with m.If(self.close):
                m.d.sync += last.eq(0)
            self.given(m, "initial_order", ~initial.valid | beat.end | (place > last))
            # Then none comes for a line that has left.
            inside = (beat.line <= self.last_line) & (beat.word <= self.last_column >> beat_bits)
            kept = initial.valid & initial.ready & ~beat.end & inside
            self.always(m, "not_dropped", ~kept | (self.front <= beat.line))
        loaded = Signal()
        m.d.comb += loaded.eq(
            initial.valid
            & initial.ready
            & ~beat.end
            & (beat.line == self.line)
            & self.is_drawn
            & self._is_mine(beat)
            & (beat.line <= self.last_line)
            & (self.word <= self.last_word)
        )
        return loaded
