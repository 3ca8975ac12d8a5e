"""The window of tiles: its lines never mix, and no pixel is lost or invented."""

from amaranth.hdl import Cat, Const, Mux, Signal, signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.tiles.dirty_bits import TileDirtyBits
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.lane import Lane
from splatline.rtl.tiles.window import TileWindow
from splatline.rtl.window.frame_overlap import FrameOverlap
from splatline.rtl.window.loader import Loader
from tests.formal.properties import OneWord, Properties, any_constant, parts
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS", "Narrow", "TileWindowProperties"]


class Narrow(EngineConfig):
    """An engine whose code word need not have 64 bits: only its window is looked at."""

    def __post_init__(self):
        """Check nothing."""


TINY = Narrow(
    window_lines=8,
    pixels_per_word=2,
    x_bits=3,
    line_bits=4,
    depth_bits=2,
    channel_bits=1,
)
"""Four words of two pixels a line, eight lines in the window, an image of up to sixteen."""


class TileWindowProperties(Properties):
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
        self.free(
            m,
            dut,
            last_column=self.last_column,
            last_line=self.last_line,
            load=Signal(init=self.load, reset_less=True, name="load"),
            shade=dut.i.payload.z,
        )
        (flush_scan,) = parts(fragment, self.flush_scan)
        self._own(m, flush_scan.oldest, flush_scan.front)
        self._mark(m, flush_scan)
        drawn = self._tiles(m)
        loaded = self._initial(m)
        self._follow(m, drawn, loaded)

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

    def _is_mine(self, beat):
        """Return whether a beat has the place of the pixel in its line."""
        return beat.word == self.word[self.config.raster_words - 1 :]

    def _depth(self, beat):
        """Return the depth of the pixel in a beat of its place."""
        return beat.pixels.depth[self._pixel()]

    def _pixel(self):
        """Return the number of the pixel in its beat."""
        return Cat(self.number, self.word[: self.config.raster_words - 1])

    def _follow(self, m, drawn, loaded):
        """Assert that the pixel leaves with its line as it was drawn, or not at all."""
        config, dut = self.config, self.dut
        background = config.background_depth
        raster, beat = dut.raster, dut.raster.payload
        width = config.depth_bits
        taken = raster.valid & raster.ready
        inside = Signal()
        m.d.comb += inside.eq(Cat(self.number, self.word) <= self.last_column)

        # What was drawn on the line that has the place, and whether that has left already.
        place_of_a_line = data.StructLayout({"line": len(self.line), "frame": 1})
        owner, owner_before = Signal(place_of_a_line), Signal(place_of_a_line)
        m.d.comb += [owner.line.eq(self.line), owner.frame.eq(self.owner)]
        due_before, gone_before = Signal(width, init=background), Signal()
        due, gone = Signal(width), Signal()
        new = Signal(width)
        passed = Signal()
        again = Signal()  # it was loaded once more, and has to leave once more
        m.d.comb += [
            # The line that has the place is another: the one before is on its way out, or empty.
            passed.eq(owner.as_value() != owner_before.as_value()),
            due.eq(Mux(passed, background, due_before)),
            gone.eq(~passed & gone_before),
            new.eq(Mux(drawn, dut.i.payload.z, self._depth(dut.initial.payload))),
        ]
        m.d.sync += [owner_before.eq(owner), due_before.eq(due)]
        with m.If((drawn | loaded) & inside & (new < due)):
            m.d.sync += due_before.eq(new)
        if self.ordered:
            self.always(m, "not_drawn_after", ~(gone & (drawn | loaded)))
            # A load keeps nothing of what was there.
            self.always(m, "loaded_first", ~(loaded & inside) | (due == background))
        else:
            with m.If(gone & loaded & inside & (new != background)):
                m.d.comb += again.eq(1)

        # Of lines that lost their place, those that are still to leave.
        pixel = data.StructLayout({"owner": place_of_a_line, "depth": width})
        kept = [Signal(pixel, name=f"kept_{n}") for n in range(2)]
        queue = [Signal(pixel, name=f"queue_{n}") for n in range(2)]
        length_before, length = Signal(2), Signal(2)
        pushed = Signal()
        m.d.comb += [
            pushed.eq(passed & (due_before != background) & ~gone_before),
            length.eq(length_before + pushed),
        ]
        for n in range(2):
            with m.If(pushed & (length_before == n)):
                m.d.comb += [queue[n].owner.eq(owner_before), queue[n].depth.eq(due_before)]
            with m.Else():
                m.d.comb += queue[n].eq(kept[n])
        self.always(m, "room", length <= 2)

        mine, first, second = Signal(), Signal(), Signal()
        source = Signal(place_of_a_line)  # the line and the frame that the beat is of
        frame = Signal()
        m.d.sync += frame.eq(frame ^ (taken & beat.end))
        depth = Signal(width)
        m.d.comb += [
            depth.eq(self._depth(beat)),
            mine.eq(
                raster.valid
                & ~beat.end
                & (beat.line[: config.slot_bits] == self.slot)
                & self._is_mine(beat)
            ),
            source.line.eq(beat.line),
            source.frame.eq(frame),
            first.eq(mine & (length != 0) & (source.as_value() == queue[0].owner.as_value())),
            second.eq(mine & ~first & (source.as_value() == owner.as_value()) & ~gone),
        ]
        m.d.sync += [kept[n].eq(queue[n]) for n in range(2)]
        m.d.sync += [
            length_before.eq(length),
            gone_before.eq((gone & ~again) | (second & raster.ready)),
        ]
        with m.If(first & raster.ready):
            m.d.sync += [kept[0].eq(queue[1]), length_before.eq(length - 1)]
        due_now = Mux(first, queue[0].depth, Mux(second, due, background))
        self.always(m, "pixel", ~mine | (depth == due_now))
        colour = Mux(depth == background, 0, depth)
        self.always(m, "colour", ~mine | (beat.pixels.colour[self._pixel()] == colour))
        waited = Signal(3)
        with m.If((length == 0) | (first & raster.ready)):
            m.d.sync += waited.eq(0)
        with m.Elif(raster.ready & ~waited.all()):
            m.d.sync += waited.eq(waited + 1)
        self.always(m, "leaves", waited < self.delay)
        left = length - (first & raster.ready)
        self.always(m, "complete", ~dut.finished | (left == 0))
        with m.If(dut.finished):
            # Of the frame that leaves; the next one's lines may be drawn by now.
            left = (due == background) | gone | (second & raster.ready)
            self.always(m, "empty", left | (self.is_drawn & dut.closing))

        # The stream as such.
        place = Signal(config.word_bits + config.line_bits + 1)
        last = Signal.like(place)
        ended = Signal()
        m.d.comb += place.eq(Cat(beat.word, beat.line) + 1)
        with m.If(taken):
            m.d.sync += last.eq(Mux(beat.end, 0, place))
        with m.If(dut.finished):
            m.d.sync += ended.eq(1)
        with m.Elif(taken & beat.end):
            m.d.sync += ended.eq(0)
        shown = Cat(depth != background for depth in beat.pixels.depth).any()
        self.always(m, "steady", self.steady(m, raster, "raster"))
        self.always(m, "end", ~raster.valid | (beat.end == ended))
        self.always(m, "order", ~raster.valid | beat.end | ((place > last) & shown))


SWEPT = Fault(
    "the sweep's last cycle", TileWindow, r"(sweep = Signal\(.*)\)", r"\1, init=-1)", "_clear"
)
"""The lanes have been cleared but for their last pixel."""


def plan(name, shows, load, depth, *faults, ordered=True, long=False):
    """Return a proof of the window."""
    return Proof(
        name=name,
        shows=shows,
        build=lambda: TileWindowProperties(TINY, load, ordered),
        depth=depth,
        engine="abc bmc3",
        changes=(SWEPT,),
        faults=faults,
        slow=True,
        long=long,
    )


PROOFS = [
    plan(
        "window of tiles",
        "a pixel leaves with its own line, as it was drawn, once; none is lost or invented",
        0,
        15,
        Fault("no conflict", TileWindow, r"\(drawn & tile\.meets\)", "(0)", "_arbitrate"),
        Fault(
            "a word leaves where a tile stood still",
            TileWindow,
            r"& ~\(stopped & drawn\)",
            "",
            "_arbitrate",
        ),
        Fault(
            "lanes not kept for a tile",
            TileWindow,
            r"& \(first \| ~\(offered & meeting\)\)",
            "",
            "_arbitrate",
        ),
        Fault("a line left too early", TileFlushScan, r"scans & moves & ", "scans & ", "_pairs"),
        Fault(
            "reached at the moment",
            TileFlushScan,
            r", now\) \| reach",
            ", now | reach)",
            "_reached",
        ),
        Fault("a turn ahead unnoticed", FrameOverlap, r"self\.wraps &", "0 &"),
        Fault("frames meet", FrameOverlap, r"turns\[1:\], self\.closing", "turns[1:], 0"),
        Fault("over too early", FrameOverlap, r"self\.clean \| self", "1 | self"),
        Fault("a frame closed twice", TileWindow, r" & ~flush_scan\.closing", "", "_connect_frame"),
        Fault("no depth test", Lane, r"en\.eq\(difference\[-1\]", "en.eq(taken.draw | taken.clear"),
    ),
    plan(
        "window of tiles, further",
        "the same, until every fault that is known of shows",
        0,
        18,
        Fault(
            "drawn while dirty bits are taken",
            TileWindow,
            r"swept & ~taking",
            "swept",
            "_arbitrate",
        ),
        Fault(
            "a tile goes where a word does", TileWindow, r"& ~\(first & meeting\)", "", "_arbitrate"
        ),
        long=True,
    ),
    plan(
        "window of tiles, initial raster",
        "the same for frames that start from an initial raster",
        1,
        14,
        Fault(
            "loaded beyond the window", Loader, r"waiting & ~drop & in_window", "waiting & ~drop"
        ),
        Fault(
            "a line left unloaded", TileFlushScan, r"self\.jump \| (\(self\.oldest < )", r"1 | \1"
        ),
        Fault("a line left while it is loaded", TileFlushScan, r"< self\.limit", "<= self.limit"),
        Fault(
            "limit a line too far", Loader, r"(limit\.eq\(Mux\(in_window, beat\.line)", r"\1 + 1"
        ),
        Fault("front a line too far", Loader, r"oldest, loaded\)", "oldest, loaded + 1)"),
        Fault("a line drawn into too early", Loader, r"\(config\.window_lines > BLOCK\)", "1"),
        Fault(
            "loaded where a word is cleared",
            TileWindow,
            r"& ~stopped(\s+& ~flush_scan\.taking)",
            r"\1",
            "_arbitrate",
        ),
        Fault(
            "loaded while dirty bits are taken",
            TileWindow,
            r"(& ~stopped\s+)& ~flush_scan\.taking",
            r"\1",
            "_arbitrate",
        ),
        Fault(
            "loaded in a tile's row",
            TileWindow,
            r"& ~\(offered & wanted\.bit_select\(loader.*\)\)",
            "",
            "_arbitrate",
        ),
        Fault(
            "a load marked in a tile's place",
            TileWindow,
            r"If\(flush_scan\.lone\[i\]\)",
            "If(0)",
            "_touch_loaded",
        ),
        Fault("a tile in a load's", TileWindow, r"lone\.eq\(.*\)", "lone.eq(-1)", "_touch_loaded"),
        Fault(
            "another pair marked",
            TileDirtyBits,
            r"load\[residue\] & \((other\[0\]) ==",
            r"load[residue] & (\1 !=",
        ),
    ),
]
