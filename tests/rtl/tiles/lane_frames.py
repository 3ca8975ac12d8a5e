"""Frames for the bench of the window of lanes, drawn in software too; and its ports."""

from splatline.contract.presets import PAPER
from splatline.sim.cosim.streams import StreamBench
from tests.rtl.tiles.tiles import Tiles, pack_tile, tiles_of
from tests.support.pictures import (
    END,
    beats_of,
    draw,
    image_of,
    random_depth,
    random_image,
    random_shade,
    random_spans,
)

__all__ = ["Bench", "Painter", "random_frame"]


class Painter:
    """Cuts elements into tiles, and draws the same picture in software."""

    def __init__(self, width, height, start=None):
        self.width, self.height = width, height
        self.start = start
        self.image = dict(start or {})
        self.tiles = []

    def element(self, top, x, spans, z, colour):
        tiles, pixels = tiles_of(top, x, spans, self.width, self.height)
        self.tiles += [{**tile, "z": z, "colour": colour} for tile in tiles]
        draw(self.image, pixels, z, colour)

    def random_elements(self, rng, count):
        """Elements in the order of their lines; now and then one right on the one before."""
        x, spans = 0, {}
        for top in sorted(rng.randrange(-4, self.height + 2) for _ in range(count)):
            if rng.random() < 0.7:
                x, spans = rng.randrange(min(512, self.width + 4)), random_spans(rng)
            self.element(top, x, spans, random_depth(rng), random_shade(rng))
        return self

    def compare(self, received):
        """Exactly the words with a pixel in them come, in order, and then the end."""
        assert received[-1] == END or received[-1] >> PAPER.raster_end.lsb
        beats = received[:-1]
        assert image_of(beats, self.width, self.height) == self.image
        assert len(beats) == len({(line, column // 4) for line, column in self.image})


class Bench:
    """A window's streams, for many frames and resets.

    As the tiler does, it offers a tile once its lines are in the window, and shows the ``top`` of
    the one to come before that: at once, or some cycles after the one before was taken.

    Parameters
    ----------
    rates
        Of tiles, initial raster and raster.
    polite
        The raster is taken only where something is offered, as any sink may do.
    """

    def __init__(self, dut, rates, seed, polite=False):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.rates, self.polite = rates, polite
        self.sent = 0  # tiles before this cycle

    async def reset(self):
        self.bench.sources.clear()
        self.bench.sinks.clear()
        self.source = self.bench.source("i", [], self.rates[0])
        self.initial = self.bench.source("initial", [], self.rates[1])
        self.raster = self.bench.sink("raster", self.rates[2])
        self.dut.active.value = self.dut.load.value = 0
        self.frame, self.shown = Painter(1, 1), 0
        await self.bench.reset()

    def open(self, frame, initial=None):
        """Offer a frame; ``initial`` are other beats than those of its start."""
        begin = self.bench.cycles

        def oldest():
            """Whether it is of a frame with an initial raster is known from the next cycle on."""
            known = self.bench.cycles > begin or frame.start is None
            return self.dut.oldest.value.to_signed() if known else -PAPER.window_lines

        tiles = Tiles(frame.tiles, oldest, lambda: self.source.sent != self.sent)
        self.frame, self.shown = frame, 0
        self.source.payloads, self.source.sent, self.sent = tiles, 0, 0
        if frame.start is not None:
            beats = initial or beats_of(frame.start, frame.width, frame.height)
            self.initial.payloads, self.initial.sent = beats, 0
        self.raster.received.clear()
        self.dut.last_column.value = frame.width - 1
        self.dut.last_line.value = frame.height - 1
        self.dut.load.value = frame.start is not None
        self.dut.active.value = 1

    def drive(self):
        """Set what comes beside the streams; what means nothing at random."""
        rng, tiles = self.bench.random, self.frame.tiles
        self.sent = sent = self.source.sent
        if self.source.offering:
            self.shown = sent + 1
        else:
            if self.shown <= sent and rng.random() < 0.7:
                self.shown = min(sent + 1, len(tiles))
            # Of the last tile that is shown; the end shows no sooner than it is offered.
            over = sent > len(tiles)
            top = -4 if over or not self.shown else tiles[min(self.shown, len(tiles)) - 1]["top"]
            noise = {"mask": rng.getrandbits(16), "meets": rng.getrandbits(1)}
            self.dut.i__payload.value = pack_tile(top=top, **noise)
        drawn = self.source.offering and sent < len(tiles)
        self.dut.shade.value = tiles[sent]["colour"] if drawn else random_shade(rng)
        if self.polite and not int(self.dut.raster__valid.value):
            self.dut.raster__ready.value = 0

    async def play(self, frame, initial=None):
        self.open(frame, initial)
        cycles = await self.bench.run(
            lambda: bool(self.raster.received) and self.raster.received[-1] >= END,
            most_cycles=15_000,
            drive=self.drive,
            after=0,
        )
        assert self.source.sent == self.source.payloads.whole
        self.dut.active.value = 0
        for _ in range(5):
            await self.bench.step(self.drive)
        frame.compare(self.raster.received)
        return cycles


def random_frame(rng, width, height, count, share=None):
    start = None if share is None else random_image(rng, width, height, share)
    return Painter(width, height, start).random_elements(rng, count)
