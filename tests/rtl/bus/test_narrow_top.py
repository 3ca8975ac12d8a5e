"""The pin-level top in Amaranth's simulator: its streams in pieces, and a frame with stalls."""

import numpy as np
import pytest
from amaranth.sim import Simulator

from splatline.contract.presets import PLANE, PRESETS
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.flow.narrow_verilog import generate_pins
from splatline.rtl.bus.narrow_top import IO_PINS, Gatherer, PinTop, Splitter
from splatline.sim import golden
from splatline.sim.cosim.player.jobs import table_writes
from tests.support import bus_words
from tests.support.faults import rewrite
from tests.support.random_frames import random_raster, shapes

LIMIT = 100_000


def simulate(top, *benches):
    """Run benches beside a component for as long as the first of them takes."""
    simulator = Simulator(top)
    simulator.add_clock(1e-8)
    simulator.add_testbench(benches[0])
    for bench in benches[1:]:
        simulator.add_testbench(bench, background=True)
    simulator.run()


def source(port, payloads, rng, rate):
    """Offers payloads, each after a random gap, and keeps it until it is taken."""

    async def bench(context):
        for payload in payloads:
            while rng.random() >= rate:
                await context.tick()
            context.set(port.payload, payload)
            context.set(port.valid, 1)
            await context.tick().until(port.ready)
            context.set(port.valid, 0)

    return bench


def sink(port, taken, done, rng, rate):
    """Takes payloads until ``done(taken)``; what is offered must stay until it is taken."""

    async def bench(context):
        waiting = None
        for _ in range(LIMIT):
            context.set(port.ready, int(rng.random() < rate))
            _, _, valid, ready, payload = await context.tick().sample(
                port.valid, port.ready, port.payload
            )
            assert waiting is None or (valid and payload == waiting)
            waiting = payload if valid and not ready else None
            if valid and ready:
                taken.append(payload)
                if done(taken):
                    return
        raise AssertionError(f"no end after {LIMIT} cycles and {len(taken)} pieces")

    return bench


def numbers(limbs):
    """Rows of limbs as whole numbers."""
    return [sum(int(limb) << 64 * place for place, limb in enumerate(row)) for row in limbs]


def split(words, pieces, bits):
    return [word >> bits * n & (1 << bits) - 1 for word in words for n in range(pieces)]


def join(taken, pieces, bits):
    rows = [taken[n : n + pieces] for n in range(0, len(taken), pieces)]
    return [sum(piece << bits * place for place, piece in enumerate(row)) for row in rows]


@pytest.mark.parametrize("rates", [(1.0, 1.0), (0.3, 1.0), (1.0, 0.3), (0.6, 0.5)])
@pytest.mark.parametrize(("bits", "piece"), [(64, 16), (90, 18), (10, 4), (5, 5)])
def test_words_come_together_and_apart_in_order(bits, piece, rates):
    rng = np.random.default_rng(bits)
    words = [int.from_bytes(rng.bytes(12), "little") & (1 << bits) - 1 for _ in range(30)]
    gatherer, splitter = Gatherer(bits, piece), Splitter(bits, piece)
    pieces = split(words, gatherer.pieces, piece)

    gathered = []
    simulate(
        gatherer,
        sink(gatherer.o, gathered, lambda taken: len(taken) == len(words), rng, rates[1]),
        source(gatherer.i, pieces, rng, rates[0]),
    )
    assert gathered == words

    parts = []
    simulate(
        splitter,
        sink(splitter.o, parts, lambda taken: len(taken) == len(pieces), rng, rates[1]),
        source(splitter.i, words, rng, rates[0]),
    )
    assert parts == pieces


def play(frame, rates, seed, initial=None, times=1):
    """Send a frame through the pins some times, one behind the other; return the pictures."""
    rng = np.random.default_rng(seed)
    config = frame.config
    top = PinTop(config)
    beat_pieces = -(-config.raster_end.end // 18)
    word_pieces = -(-max(config.codeword_bits, config.table_address.end) // 16)
    codewords = numbers(frame.codewords.reshape(len(frame.codewords), -1))
    writes = table_writes(frame.tables, frame.width, frame.height, initial is not None, config)
    used = {word >> config.material.lsb & config.material.mask for word in codewords}
    writes = [w for n, w in enumerate(numbers(writes)) if n in used or n >= config.register_base]
    words = [piece | 1 << 16 for piece in split(writes, word_pieces, 16)]
    words += split(codewords, word_pieces, 16)
    payloads = [{"data": word & 0xFFFF, "table": word >> 16} for word in words * times]
    beats = [] if initial is None else split(numbers(to_beats(initial)), beat_pieces, 18)

    ends = []

    def done(taken):
        if len(taken) % beat_pieces == 0:
            beat = join(taken[-beat_pieces:], beat_pieces, 18)[0]
            if beat >> config.raster_end.lsb & 1:
                ends.append(len(taken) // beat_pieces)
        return len(ends) == times

    taken = []
    simulate(
        top,
        sink(top.raster, taken, done, rng, rates["raster"]),
        source(top.words, payloads, rng, rates["words"]),
        source(top.initial, beats * times, rng, rates["initial"]),
    )
    found = join(taken, beat_pieces, 18)
    limbs = -(-config.raster_end.end // 64)
    pictures = []
    for first, last in zip([0, *ends], ends, strict=False):
        rows = [
            [beat >> 64 * place & (1 << 64) - 1 for place in range(limbs)]
            for beat in found[first:last]
        ]
        pictures.append(
            from_beats(np.array(rows, np.uint64), frame.width, frame.height, frame.config)
        )
    return pictures


RATES = [
    {"words": 1.0, "initial": 1.0, "raster": 1.0},
    {"words": 0.5, "initial": 0.9, "raster": 0.9},
    {"words": 0.9, "initial": 0.3, "raster": 0.2},
]


@pytest.mark.parametrize("rates", RATES)
def test_a_frame_through_the_pins_is_golden_s(rates):
    frame = shapes(np.random.default_rng(1), 40, 24, 20)
    for picture in play(frame, rates, 2, times=2):
        assert picture.mismatches(golden.render(frame)) == 0


@pytest.mark.parametrize("rates", RATES)
def test_an_initial_raster_and_code_words_never_block_each_other(rates):
    """More lines than the window: each of the two has to wait for the other on the way."""
    rng = np.random.default_rng(3)
    frame = shapes(rng, 40, 12, 40)
    initial = random_raster(rng, 12, 40, 0.3)
    (picture,) = play(frame, rates, 4, initial=initial)
    assert picture.mismatches(golden.render(frame, initial)) == 0


def test_a_preset_whose_table_writes_are_longer_than_code_words():
    frame = shapes(np.random.default_rng(5), 30, 16, 12, config=PRESETS["rgb24"])
    assert frame.config.table_address.end > 64
    (picture,) = play(frame, RATES[1], 6)
    assert picture.mismatches(golden.render(frame)) == 0


PLANES = bus_words.clean(PLANE, 7, 30, 16, 12)
"""A frame of plane words."""


@pytest.mark.parametrize("rates", RATES[:2])
def test_plane_words_are_six_pieces(rates):
    assert PLANE.codeword_bits == 6 * 16 > PLANE.table_address.end
    initial = random_raster(np.random.default_rng(8), 16, 12, 0.3, PLANE)
    (picture,) = play(PLANES, rates, 8, initial=initial)
    assert picture.mismatches(golden.render(PLANES, initial)) == 0


@pytest.mark.planted
def test_the_high_pieces_of_plane_words_are_noticed_if_they_are_lost(monkeypatch):
    whole = r"codewords\.payload\.eq\(words\.o\.payload\)"
    rewrite(monkeypatch, PinTop, "elaborate", whole, "codewords.payload.eq(words.o.payload[:64])")
    (picture,) = play(PLANES, RATES[0], 8)
    assert picture.mismatches(golden.render(PLANES))


@pytest.mark.parametrize(
    "config", [*map(PRESETS.get, ("paper", "rgb24", "swift")), PLANE], ids=lambda c: c.name
)
def test_presets_have_the_same_few_pins(config):
    """Whatever their words and beats."""
    text, description = generate_pins(config, "top")
    assert "module top(" in text
    assert sum(port["width"] for port in description["ports"]) == 61 < IO_PINS // 2
    ports = {port["name"]: port for port in description["ports"]}
    assert ports["words__payload"]["direction"] == "input"
    assert [field["name"] for field in ports["words__payload"]["fields"]] == ["data", "table"]
    assert ports["raster__payload"]["width"] == 18
