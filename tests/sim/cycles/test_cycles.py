import itertools

import numpy as np
import pytest

from splatline.cli.bench.engine.few_elements import few_splats
from splatline.contract.errors import InputError
from splatline.contract.presets import LANES8, PAPER, PLANE, RGB24, SWIFT, SWIFT_PLANE
from splatline.host.encode.partition import partition
from splatline.host.encode.sort_by_line import advance_word
from splatline.rtl.engine import engine_latency
from splatline.rtl.tiles.lane import lane_address_bits
from splatline.sim import golden
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cycles.cycles import clearing_cycles, count_cycles
from tests.support import codewords as cw
from tests.support.engines import engine
from tests.support.random_frames import frame_of, nonsense, shapes, word
from tests.support.scene_frames import scene_frame
from tests.support.variants import variant

DOT = [*cw.NOTHING[1:], (4, 4)]
LINE = [*cw.NOTHING[1:], (0, 7)]


def element(rng, rows, x, config=PAPER):
    return cw.encode(rows, x=int(x), mode=int(rng.integers(2)), z=int(rng.integers(400)),
                     config=config)  # fmt: skip


def crowded(rng, count, width, height, spread, advance):
    """Elements of any rows within a few columns, so that one follows another into its words."""
    words = []
    for _ in range(count):
        rows = rng.integers(0, 8, (4, 2)).tolist()
        words.append(element(rng, rows, rng.integers(0, spread)))
        if rng.random() < advance:
            words.append(cw.advance(int(rng.integers(0, 3))))
    return cw.make_frame([*words, cw.end()], (width, height))


def jumping(rng, count, width, height, furthest):
    """Elements here and there, few on a line, with lines between that nothing is written into."""
    words = []
    for _ in range(count):
        rows = [cw.EVERYTHING, DOT, LINE, cw.NOTHING][rng.integers(4)]
        words += [element(rng, rows, rng.integers(0, width))] * int(rng.integers(0, 4))
        words += [cw.advance(int(rng.integers(0, furthest)))] * int(rng.integers(1, 4))
    return cw.make_frame([*words, cw.end()], (width, height))


def climbing(rng, count, width, height, step):
    """Wide elements and narrow ones by turns: the window must move on while lanes are busy."""
    words = []
    for index in range(count):
        rows = DOT if rng.random() < 0.3 else cw.EVERYTHING
        words += [element(rng, rows, rng.integers(0, width))] * int(rng.integers(1, 5))
        if index % 3 == 0:
            words.append(cw.advance(int(rng.integers(0, step))))
    return cw.make_frame([*words, cw.end()], (width, height))


def trials():
    """Frames by name, in the order in which they are played."""
    rng = np.random.default_rng(77)
    frames = {
        # The first is drawn while the window is being cleared.
        "first": crowded(rng, 500, 64, 40, 40, 0.1),
        # The next one too, and its first element wants the word that is cleared last.
        "cleared": cw.make_frame(
            [cw.advance(9), *[cw.encode(cw.EVERYTHING, x=508)] * 2, cw.end()], (512, 512)
        ),
        "at once": cw.make_frame([cw.end()], (512, 512)),
        "no elements": cw.make_frame([*[cw.advance(3)] * 40, cw.end()], (64, 64)),
        "one dot": cw.make_frame([cw.encode(DOT, x=9), cw.end()], (64, 64)),
        "last dot": cw.make_frame([cw.advance(511), cw.encode(DOT, x=507), cw.end()], (512, 512)),
        "below": cw.make_frame(
            [cw.encode(DOT), *[cw.advance(511)] * 9, *[cw.encode(cw.EVERYTHING)] * 5, cw.end()],
            (64, 64),
        ),
        "one place": cw.make_frame(
            [cw.advance(9), *[cw.encode(DOT, x=8)] * 300, cw.end()], (64, 64)
        ),
        "two places": cw.make_frame(
            [cw.advance(9), *[cw.encode(DOT, x=8), cw.encode(LINE, x=5)] * 300, cw.end()], (64, 64)
        ),
        "terrain": scene_frame("terrain", view={"size": (192, 128)}),
        "knot": scene_frame("knot", view={"size": (96, 160)}),
    }
    for width, height in [(1, 1), (5, 3), (8, 17), (64, 40), (512, 1024), (509, 30)]:
        size = f"{width}x{height}"
        frames |= {
            f"any bits, {size}": nonsense(rng, 700, width, height),
            f"any bits, flat, {size}": nonsense(rng, 400, width, height, advance=0.002),
            f"steps, {size}": nonsense(rng, 700, width, height, advance=0.7),
            f"shapes, {size}": shapes(rng, 700, width, min(height, 300)),
            f"crowded, {size}": crowded(rng, 500, width, height, 12, 0.05),
            f"jumping, {size}": jumping(rng, 60, width, height, 40),
            f"leaping, {size}": jumping(rng, 30, width, height, 400),
            f"climbing, {size}": climbing(rng, 200, width, height, 7),
        }
    return frames


AFTER_RESET = ("first", "cleared")


@pytest.fixture(scope="module")
def played():
    """Each frame and the cycles that the Verilog takes for it."""
    frames = trials()
    jobs = [
        Job(frame=frame, reset_after=30 if name == "cleared" else None)
        for name, frame in frames.items()
    ]
    outcomes = play(jobs, built=engine())
    return {
        name: (frame, outcome.cycles)
        for (name, frame), outcome in zip(frames.items(), outcomes, strict=True)
    }


def test_the_count_is_that_of_the_verilog_to_the_cycle(played):
    counted = {
        name: count_cycles(frame, after_reset=name in AFTER_RESET)
        for name, (frame, _) in played.items()
    }
    assert counted == {name: cycles for name, (_, cycles) in played.items()}


def cycles_of_ten_splats(config, draw):
    """Return what ``draw`` takes: of a second frame, as the window is cleared before the first."""
    frame = few_splats(10, (512, 512), config)
    _, second = draw([Job(frame=frame), Job(frame=frame)])
    assert not second.raster.mismatches(golden.render(frame))
    assert second.cycles == count_cycles(frame, after_reset=False)
    return second.cycles


@pytest.mark.parametrize(
    ("config", "most"),
    # ``swift-plane`` is built in tests/rtl/blocks/test_planes.py, which has the same of it.
    [(RGB24, 220), (SWIFT, 100), (PLANE, 240)],
    ids=["rgb24", "swift", "plane"],
)
def test_ten_splats_anywhere_take_few_cycles(config, most):
    """By Verilog and model."""
    assert cycles_of_ten_splats(config, lambda jobs: play(jobs, built=engine(config))) <= most


def test_without_conflicts_the_count_would_be_another(played):
    for name in ("crowded, 64x40", "climbing, 64x40", "shapes, 64x40", "terrain", "knot"):
        frame, cycles = played[name]
        assert count_cycles(frame, after_reset=False, conflicts=False) < cycles, name


def test_clearing_the_window_holds_a_first_frame_up(played):
    frame, cycles = played["first"]
    assert count_cycles(frame, after_reset=False) < cycles
    assert clearing_cycles(PAPER) == (1 << lane_address_bits(PAPER)) - (128 + 6) - 4


@pytest.mark.parametrize(
    "config",
    [
        *(PAPER, LANES8, SWIFT, PLANE, SWIFT_PLANE),
        *(variant("depth12"), variant("lines32"), variant("word2")),
    ],
    ids=lambda config: config.name,
)
def test_known_counts(config):
    """A cycle a code word, one more for its latency, and the end beat behind.

    Tiles know one cycle later that nothing is left in the window, blocks have the end beat in a
    queue.
    """
    tiles = not config.draws_blocks
    latency = engine_latency(config) + 1

    def count(words):
        return count_cycles(frame_of(words, 64, 64, config=config), after_reset=False)

    def dot(column):
        return word(DOT, column, 0, config=config)

    assert count([]) == latency + 1
    assert count([advance_word(1, config)] * 10) == latency + 11
    # One dot: the word leaves in the cycle after the end token has come, and the end token then
    # waits until it is out: the line above is complete (1), flushed, merged, emitted. With tiles,
    # dots on the same word wait a cycle each but the first, and a pair of words leaves anyway. With
    # blocks none waits, and dots in beats of their own leave as so many beats.
    for dots in (1, 2) if tiles else (1, 2, 4):
        # Of lanes the first of a pair of words, and the second.
        first = 2 * config.pixels_per_word - 4 if tiles else 4
        columns = [first + config.pixels_per_word * n for n in range(dots)]
        apart = [dot(column) for column in columns]
        same = [dot(first)] * dots
        start = advance_word(4, config)
        beats = 1 if tiles else len({(c + DOT[-1][0]) // config.raster_pixels for c in columns})
        waits = 0 if config.draws_blocks else dots - 1
        assert count([start, *same]) - count([start, *apart]) == waits - (beats - 1)


def test_more_words_never_take_less():
    rng = np.random.default_rng(4)
    frame = crowded(rng, 60, 40, 30, 20, 0.2)
    words = frame.codewords.tolist()[:-1]
    counts = [
        count_cycles(cw.make_frame([*words[:count], cw.end()], (40, 30)))
        for count in range(len(words) + 1)
    ]
    assert all(before <= after for before, after in itertools.pairwise(counts))


@pytest.mark.parametrize("words", [[], [cw.encode(cw.EVERYTHING)] * 30, [cw.advance(3)]])
def test_a_stream_without_an_end_is_cut_short(words):
    with pytest.raises(InputError, match="no end-of-frame word"):
        count_cycles(cw.make_frame(words, (8, 8)))


@pytest.mark.parametrize(
    ("config", "most"),
    # A strip of 64 columns has but eight words of eight pixels, and each of its turns under three.
    [(PAPER, 1.03), (RGB24, 1.03), (SWIFT, 1.05), (PLANE, 1.03)],
    ids=["paper", "rgb24", "swift", "plane"],
)
@pytest.mark.parametrize("engines", [1, 4])
def test_elements_dealt_to_a_chain_hardly_meet_in_memory(config, most, engines):
    """An engine's part of a dense frame: elements that follow each other lie in other words."""
    frame = scene_frame("terrain", view={"size": (256, 256)}, config=config)
    for part in partition(frame, engines, "columns"):
        apart = count_cycles(part, after_reset=False, conflicts=False)
        assert count_cycles(part, after_reset=False) < most * apart


def test_words_after_the_end_are_not_counted():
    words = [cw.encode(cw.EVERYTHING, x=3), cw.end()]
    short, long = (cw.make_frame(words + more, (30, 20)) for more in ([], words * 9))
    assert count_cycles(short) == count_cycles(long)
