"""The window: footprints in, raster out, as if it were one large image."""

import random

import cocotb
import pytest
from footprints import Footprints, end_token, footprint
from presets import CONFIG, OTHERS, run_bench
from test_scatter import random_spans

from splatline.rtl.format import BAYER
from splatline.rtl.layouts import RasterLayout
from splatline.rtl.presets import PAPER
from splatline.rtl.window import Window
from splatline.sim.cosim import blocks
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench

RASTER = RasterLayout(CONFIG)
DEPTH = CONFIG.background_depth
BACKGROUND = (DEPTH, 0)
END = 1 << CONFIG.raster_end.lsb
PIXELS = CONFIG.raster_pixels
FRACTION = 4 if CONFIG.dither else 0


def random_shade(rng):
    """An element's colour: its channels with the fraction bits, if there are any."""
    return rng.getrandbits(3 * (CONFIG.channel_bits + FRACTION))


def colour_of(shade, line, column):
    """A pixel's colour: the threshold of its place added, and the fraction dropped."""
    if not CONFIG.dither:
        return shade
    width = CONFIG.channel_bits + FRACTION
    colour = 0
    for channel in range(3):
        value = (shade >> width * channel & (1 << width) - 1) + BAYER[line % 4][column % 4]
        colour |= min(value >> FRACTION, CONFIG.channel_max) << CONFIG.channel_bits * channel
    return colour


def draw(image, pixels, z, shade):
    for line, column in pixels:
        if z < image.get((line, column), BACKGROUND)[0]:
            image[line, column] = (z, colour_of(shade, line, column))


def beats_of(image, width, height):
    """Raster beats of an image {(line, column): (depth, colour)}, sparse."""
    places = sorted({(line, column // PIXELS) for line, column in image})
    beats = []
    for line, word in places:
        pixels = [image.get((line, PIXELS * word + i), BACKGROUND) for i in range(PIXELS)]
        depth, colour = [p[0] for p in pixels], [p[1] for p in pixels]
        word_bits = {"depth": depth, "colour": colour}
        beats.append(pack(RASTER, pixels=word_bits, word=word, line=line))
    return [*beats, END]


def image_of(received, width, height):
    """The image that beats describe; checks their order and places."""
    image, before = {}, (-1, -1)
    for bits in received:
        beat = unpack(RASTER, bits)
        assert not beat.end
        assert before < (beat.line, beat.word), "beats out of order"
        before = (beat.line, beat.word)
        assert beat.line < height
        assert beat.word <= (width - 1) // PIXELS
        assert any(depth != DEPTH for depth in beat.pixels.depth), "a word of background was sent"
        for i in range(PIXELS):
            pixel = (beat.pixels.depth[i], beat.pixels.colour[i])
            if PIXELS * beat.word + i >= width:
                assert pixel == BACKGROUND, "drawn outside the image"
            elif pixel[0] != DEPTH:
                image[beat.line, PIXELS * beat.word + i] = pixel
    return image


def random_depth(rng):
    """One of few depths, so that ties are common: the first to draw a pixel keeps it."""
    return DEPTH // 8 * rng.randrange(8)


def random_image(rng, width, height, share):
    return {
        (line, column): (random_depth(rng), rng.getrandbits(CONFIG.colour_bits))
        for line in range(height)
        for column in range(width)
        if rng.random() < share
    }


async def check(dut, frames, rates, seed):
    """Play frames of (elements, initial image or None) of one size, one after the other."""
    rng = random.Random(seed)
    bench = StreamBench(dut, seed)
    source = bench.source("i", [], rates[0])
    initial = bench.source("initial", [], rates[1])
    raster = bench.sink("raster", rates[2])
    dut.active.value = 0

    shades = []
    offered = shade = None

    def show():
        """As a decoder shows the next first line early; a colour moves on with its element."""
        nonlocal offered
        offered = source.sent if source.offering else None
        if offered is None:
            dut.i__payload.value = source.payloads.shown(bench.random, source.sent)
        dut.shade.value = random_shade(bench.random) if shade is None else shade

    def look():
        nonlocal shade
        if int(dut.running.value):
            source.payloads.oldest = dut.oldest.value.to_signed()
        if int(dut.moves.value):
            drawn = offered is not None and offered < len(shades)
            shade = shades[offered] if drawn else None

    source.payloads = Footprints()
    source.sent = 1
    await bench.reset()
    for width, height, count, start in frames:
        tops = sorted(rng.randrange(-4, height + 2) for _ in range(count))
        image, elements = dict(start or {}), []
        shades.clear()
        for top in tops:
            z, colour = random_depth(rng), random_shade(rng)
            x = rng.randrange(min(512, width + 4))
            bits, pixels = footprint(top, x, random_spans(rng), z, width, height)
            elements.append((top, bits))
            shades.append(colour)
            draw(image, pixels, z, colour)
        source.payloads = Footprints(elements)
        source.sent = 0
        if start is not None:
            # Whether there is an initial raster is known to the window a cycle later.
            source.payloads.oldest = -CONFIG.window_lines
            initial.payloads, initial.sent = beats_of(start, width, height), 0
        raster.received.clear()
        dut.last_column.value = width - 1
        dut.last_line.value = height - 1
        dut.load.value = start is not None
        dut.active.value = 1
        await bench.run(
            lambda: bool(raster.received) and raster.received[-1] >= END,
            most_cycles=200_000,
            drive=show,
            observe=look,
            after=0,
        )
        dut.active.value = 0
        for _ in range(5):
            await bench.step(show, look)
        assert raster.received[-1] >= END, "something followed the end"
        assert image_of(raster.received[:-1], width, height) == image


@cocotb.test()
async def without_stalls(dut):
    """Frames of several sizes back to back, with and without an initial raster."""
    rng = random.Random(1)
    frames = [
        (40, 30, 400, None),
        (40, 30, 400, random_image(rng, 40, 30, 0.3)),
        (512, 9, 300, None),
        (37, 21, 0, None),
        (37, 21, 0, random_image(rng, 37, 21, 1.0)),
        (1, 1, 5, None),
        (6, 200, 60, random_image(rng, 6, 200, 0.1)),
    ]
    await check(dut, frames, (1.0, 1.0, 1.0), 1)


@cocotb.test()
async def with_stalls(dut):
    """The same pictures whatever each port's rate."""
    for seed, rates in enumerate(
        [(0.3, 1.0, 1.0), (1.0, 0.1, 0.9), (1.0, 1.0, 0.15), (0.5, 0.5, 0.5)]
    ):
        rng = random.Random(seed)
        frames = [
            (33, 25, 250, None),
            (33, 25, 250, random_image(rng, 33, 25, 0.4)),
            (8, 40, 100, random_image(rng, 8, 40, 0.05)),
        ]
        await check(dut, frames, rates, seed)


@cocotb.test()
async def words_right_behind_what_leaves(dut):
    """An initial raster of one word a line, each of which enters where another is just cleared.

    Elements that come slowly let the window fill up.
    """
    for seed, rate in enumerate((1.0, 0.6, 0.3)):
        start = {(line, 0): (9, line) for line in range(200)}
        await check(dut, [(1, 200, 0, start), (1, 200, 60, start)], (0.1, 1.0, rate), seed)


@cocotb.test()
async def dense_over_a_picture(dut):
    """Words to load are always there, and elements: each has to leave banks to the other."""
    rng = random.Random(10)
    await check(dut, [(120, 40, 1200, random_image(rng, 120, 40, 1.0))], (1.0, 1.0, 1.0), 10)


@cocotb.test()
async def in_short(dut):
    """A little of everything, for what is simulated slowly or often."""
    rng = random.Random(6)
    # Tall enough for the elements and the initial raster to take turns often.
    frames = [(9, 45, 90, random_image(rng, 9, 45, 0.4)), (30, 20, 100, None)]
    await check(dut, frames, (0.9, 0.4, 0.6), 6)


@cocotb.test()
async def at_a_glance(dut):
    """A frame that starts from a picture, for Icarus, to which a window of banks is large."""
    await check(dut, [(9, 20, 30, random_image(random.Random(6), 9, 20, 0.4))], (0.9, 0.9, 0.6), 6)


@cocotb.test()
async def few_far_apart(dut):
    """The window is clean between one element and the next, which may lie anywhere."""
    await check(dut, [(512, 900, 60, None), (512, 300, 60, None)], (1.0, 1.0, 1.0), 8)
    await check(dut, [(512, 900, 60, None)], (0.3, 1.0, 0.5), 9)


@cocotb.test()
async def lines_jump_while_the_raster_waits(dut):
    """A word is drawn into the place of one that left just now, many lines above."""
    for seed, rate in enumerate((0.2, 0.4, 0.6, 0.8)):
        await check(dut, [(8, 700, 120, None)] * 3, (1.0, 1.0, rate), seed)


@cocotb.test()
async def nonsense_in_the_initial_raster(dut):
    """Beats outside the image or out of order fall nowhere but on their own place.

    And those across its border but on what is inside, of which on some lines nothing is drawn.
    """
    rng = random.Random(5)
    width, height = 18, 24
    image = random_image(rng, width, height, 0.5)
    beyond = {
        (line, column): (1, 7) for line in range(height) for column in range((18, 20)[line % 2], 24)
    }
    good = beats_of(image | beyond, width, height)[:-1]
    full = {"depth": [1] * PIXELS, "colour": [7] * PIXELS}
    outside = [
        pack(RASTER, pixels=full, word=word, line=line)
        for word, line in ((5, 3), (512 // PIXELS - 1, 0), (0, 24), (3, 1023))
    ]
    beats = [*good]
    for bits in outside:
        beats.insert(rng.randrange(len(beats)), bits)
    beats.append(good[0])  # its line has left long ago
    bench = StreamBench(dut, 5)
    bench.source("i", [end_token()])
    bench.source("initial", [*beats, END])
    raster = bench.sink("raster", 0.7)
    dut.last_column.value, dut.last_line.value = width - 1, height - 1
    dut.load.value, dut.active.value = 1, 1
    await bench.reset()
    await bench.run(
        lambda: bool(raster.received) and raster.received[-1] >= END, most_cycles=20_000
    )
    assert image_of(raster.received[:-1], width, height) == image


def test_window_draws_every_frame(simulator_name):
    """In Icarus one frame: all of it would take five minutes there."""
    test = None if simulator_name == "verilator" else "at_a_glance"
    blocks.run_bench(Window(PAPER), __file__, simulator_name=simulator_name, test=test)


# ``wide`` and ``rgb18`` are played in ``test_faults`` without a fault; each other takes a build.
@pytest.mark.parametrize(
    "config", [c for c in OTHERS if c.name in ("dither", "rgb24")], ids=lambda config: config.name
)
def test_window_draws_other_presets_frames(config):
    run_bench(config, Window, __file__, test="in_short")
