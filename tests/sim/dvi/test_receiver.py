"""The DVI receiver, against a transmitter written from the specification's flow chart."""

import functools
import importlib.util
from importlib import metadata

import numpy as np
import pytest

from splatline.sim.dvi.receiver import DviError, receive, unpack_pins
from splatline.sim.dvi.tmds import CONTROL, control_codes, decode

WIDTH, HEIGHT = 12, 5
BLANK, BLANK_LINES = 20, 4


@functools.cache
def minimised(value):
    """Return q_m of a byte: 9 bits of few transitions (figure 3-5 of the specification)."""
    bits = [value >> n & 1 for n in range(8)]
    xnor = sum(bits) > 4 or (sum(bits) == 4 and not bits[0])
    word = [bits[0]]
    for bit in bits[1:]:
        word.append(word[-1] ^ bit ^ xnor)
    return [*word, int(not xnor)]


class Encoder:
    """A channel with its running disparity."""

    def __init__(self):
        self.disparity = 0

    def data(self, value):
        word = minimised(value)
        balance = 2 * sum(word[:8]) - 8
        if self.disparity == 0 or balance == 0:
            invert = not word[8]
            self.disparity += -balance if invert else balance
        else:
            invert = (self.disparity > 0) == (balance > 0)
            if invert:
                self.disparity += 2 * word[8] - balance
            else:
                self.disparity += balance - 2 * (1 - word[8])
        return [bit ^ invert for bit in word[:8]] + [word[8], int(invert)]

    def control(self, code):
        self.disparity = 0
        return [CONTROL[code] >> n & 1 for n in range(10)]


def transmit(pictures):
    """Return the bits of pictures on three channels: shape (3, bits)."""
    channels = [[], [], []]
    encoders = [Encoder() for _ in channels]
    for picture in pictures:
        for line in range(HEIGHT + BLANK_LINES):
            vsync = line >= HEIGHT + 1
            for column in range(WIDTH + BLANK):
                hsync = WIDTH + 3 <= column < WIDTH + 6
                for number, (bits, encoder) in enumerate(zip(channels, encoders, strict=True)):
                    if line < HEIGHT and column < WIDTH:
                        bits += encoder.data(int(picture[line, column, 2 - number]))
                    else:
                        bits += encoder.control(hsync + 2 * vsync if number == 0 else 0)
    return np.array(channels, np.uint8)


@pytest.fixture(scope="module")
def pictures():
    return np.random.default_rng(1).integers(256, size=(4, HEIGHT, WIDTH, 3)).astype(np.uint8)


def pins_of(channels):
    return (channels << np.arange(3, dtype=np.uint8)[:, None]).sum(axis=0).astype(np.uint8)


@pytest.mark.parametrize("cut", [0, 3, 17])
@pytest.mark.parametrize("skew", [(0, 0), (4, -2), (-5, 4)])
def test_pictures_come_back(pictures, cut, skew):
    bits = transmit(pictures)
    shifted = [np.roll(channel, late) for channel, late in zip(bits, (0, *skew), strict=True)]
    screen = receive(pins_of(np.stack(shifted)[:, 10 + cut : -10]))
    assert screen.characters == (WIDTH + BLANK) * (HEIGHT + BLANK_LINES)
    assert (screen.pictures == pictures[1:]).all()
    assert screen.skew == skew


def test_every_byte_comes_back_in_every_channel():
    values = np.arange(256, dtype=np.uint8)
    encoder = Encoder()
    words = [encoder.data(int(value)) for value in np.tile(values, 4)]
    characters = (np.array(words) << np.arange(10)).sum(axis=1).astype(np.uint16)
    assert (decode(characters) == np.tile(values, 4)).all()
    assert (control_codes(characters) == -1).all()


def test_what_is_no_picture_is_said(pictures):
    with pytest.raises(DviError, match="no run of control characters"):
        receive(np.zeros(5000, np.uint8))
    bits = transmit(pictures[:1])
    with pytest.raises(DviError, match="no whole refresh"):
        receive(pins_of(bits))
    bits = transmit(pictures)
    with pytest.raises(DviError, match="where they have data"):
        receive(pins_of(np.stack([bits[0], bits[1], np.roll(bits[2], 7)])))
    lost = np.delete(bits, slice(2000, 2010), axis=1)
    with pytest.raises(DviError, match="different lengths"):
        receive(pins_of(lost))


def test_a_record_has_the_first_bit_in_the_low_half():
    assert unpack_pins(np.array([0x21, 0x43], np.uint8)).tolist() == [1, 2, 3, 4]


def test_the_decoder_of_cocotbext_dvi_says_the_same_of_every_character():
    """Only where it is installed: it needs OpenCV, which no extra brings."""
    try:
        files = metadata.files("cocotbext-dvi") or []
    except metadata.PackageNotFoundError:
        pytest.skip("cocotbext-dvi is not installed")
    (path,) = [file.locate() for file in files if file.name == "tmds.py"]
    spec = importlib.util.spec_from_file_location("tmds", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)  # alone: its package imports OpenCV
    other = module.TMDS()
    characters = np.arange(1024, dtype=np.uint16)
    for character, value, code in zip(
        characters.tolist(), decode(characters), control_codes(characters), strict=True
    ):
        data, enabled, vsync, hsync = other.decode(character)
        assert enabled == (code < 0)
        assert (data == value) if enabled else (hsync + 2 * vsync == code)
