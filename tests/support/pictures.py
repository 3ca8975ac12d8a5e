"""Small pictures {(line, column): (depth, colour)} as elements and beats, for window benches."""

from splatline.rtl.layouts import RasterLayout
from splatline.sim.cosim.blocks import pack, unpack
from tests.support.bench_config import CONFIG

__all__ = [
    "BACKGROUND",
    "END",
    "RASTER",
    "beats_of",
    "draw",
    "image_of",
    "random_depth",
    "random_image",
    "random_shade",
    "random_spans",
]

RASTER = RasterLayout(CONFIG)
DEPTH = CONFIG.background_depth
BACKGROUND = (DEPTH, 0)
END = 1 << CONFIG.raster_end.lsb
PIXELS = CONFIG.raster_pixels


def random_shade(rng):
    """Return a random colour of an element."""
    return rng.getrandbits(CONFIG.colour_bits)


def random_spans(rng):
    """Return the spans {row of a block: (first column, last column)} of a random element."""
    rows = rng.choice([range(8), range(4), range(2, 6), [rng.randrange(8)], []])
    spans = {}
    for row in rows:
        first = rng.randrange(8)
        spans[row] = (first, rng.randrange(first, 8))
    return spans


def draw(image, pixels, z, colour):
    """Draw pixels (line, column) of an element into an image, with the depth test."""
    for line, column in pixels:
        if z < image.get((line, column), BACKGROUND)[0]:
            image[line, column] = (z, colour)


def beats_of(image, width, height):
    """Return the raster beats of an image {(line, column): (depth, colour)}."""
    places = sorted({(line, column // PIXELS) for line, column in image})
    beats = []
    for line, word in places:
        pixels = [image.get((line, PIXELS * word + i), BACKGROUND) for i in range(PIXELS)]
        depth, colour = [p[0] for p in pixels], [p[1] for p in pixels]
        word_bits = {"depth": depth, "colour": colour}
        beats.append(pack(RASTER, pixels=word_bits, word=word, line=line))
    return [*beats, END]


def image_of(received, width, height):
    """Return the image of raster beats; check their order and positions."""
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
    """Return one of few depths, so that ties are common; the first element keeps the pixel."""
    return DEPTH // 8 * rng.randrange(8)


def random_image(rng, width, height, share):
    return {
        (line, column): (random_depth(rng), rng.getrandbits(CONFIG.colour_bits))
        for line in range(height)
        for column in range(width)
        if rng.random() < share
    }
