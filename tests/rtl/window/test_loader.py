"""The loader: which words of an initial raster reach the window, and what it says of the rest."""

import random
from pathlib import Path

import cocotb
import pytest

from splatline.contract.presets import PAPER, SWIFT
from splatline.flow.verilog import convert
from splatline.rtl.layouts import LoadLayout
from splatline.rtl.window.loader import Loader
from splatline.sim.cosim import simulator
from splatline.sim.cosim.blocks import pack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, run_bench

LAST_LINE, LAST_WORD = 99, 9
LINES = CONFIG.window_lines
LAYOUT = LoadLayout(CONFIG)


def beat(line, word):
    """A beat of the initial raster; ``word`` counts in beats."""
    count = CONFIG.raster_pixels
    pixels = {"depth": [line % 511] * count, "colour": [word] * count}
    return pack(LAYOUT, pixels=pixels, line=line, word=CONFIG.raster_words * word)


def end():
    return pack(LAYOUT, end=1)


def setup(dut, enable=1, active=1):
    dut.enable.value, dut.active.value = enable, active
    dut.last_line.value, dut.last_word.value = LAST_LINE, CONFIG.raster_words * LAST_WORD
    dut.oldest.value, dut.restart.value = 0, 0


def told(dut):
    """What it says: whether nothing more comes, and from where on lines wait and are drawn."""
    limit, front = (signal.value.to_signed() for signal in (dut.limit, dut.front))
    return {"finished": int(dut.finished.value), "limit": limit, "front": front}


@cocotb.test()
async def words_enter_with_their_lines(dut):
    """The window slides past random beats: each within it goes in, nonsense goes nowhere.

    As the window does, it lets no line leave that may still receive a word; and at no time is a
    line said to be complete of which a word is still to go in.
    """
    for seed, rates in enumerate([(1.0, 1.0), (0.5, 0.6), (1.0, 0.2)]):
        rng = random.Random(seed)
        places = [(rng.randrange(120), rng.randrange(14)) for _ in range(400)]
        places.sort(key=lambda place: place[0])
        bench = StreamBench(dut, seed)
        source = bench.source("i", [*(beat(*place) for place in places), end()], rates[0])
        sink = bench.sink("o", rates[1])
        setup(dut)
        await bench.reset()
        inside = [p for p in places if p[0] <= LAST_LINE and p[1] <= LAST_WORD]
        oldest = limit = 0
        for _ in range(6000):
            seen, written = {}, len(sink.received)
            complete = inside[written][0] if written < len(inside) else 1000

            def drive(oldest=oldest):
                dut.oldest.value = oldest

            await bench.step(drive, lambda seen=seen: seen.update(told(dut)))
            if seen["finished"]:
                assert written == len(inside)
                assert seen["front"] == oldest
                break
            assert limit <= seen["limit"] <= min(complete, oldest + LINES)
            limit = seen["limit"]
            assert seen["front"] == limit - LINES + 1, "the window's last line is not drawn into"
            if oldest < limit and rng.random() < 0.5:
                oldest += 1
        assert source.sent == len(source.payloads)
        assert sink.received == [beat(*place) for place in inside]


@cocotb.test()
async def a_line_above_the_one_before_is_dropped(dut):
    """Though it is in the window: lines enter in order, words of a line in any order."""
    bench = StreamBench(dut, 6)
    source = bench.source("i", [beat(4, 7), beat(4, 2), beat(6, 0), beat(5, 1), beat(6, 3), end()])
    sink = bench.sink("o")
    setup(dut)
    await bench.reset()
    for frame in range(2):
        source.sent = 0
        sink.received.clear()
        for _ in range(20):
            await bench.step()
        assert source.sent == len(source.payloads), frame
        assert sink.received == [beat(4, 7), beat(4, 2), beat(6, 0), beat(6, 3)]
        await bench.step(lambda: setattr(dut.restart, "value", 1))
        await bench.step(lambda: setattr(dut.restart, "value", 0))


@cocotb.test()
async def a_word_waits_for_its_line_and_says_so(dut):
    """Beyond the window a beat stays, and the window counts as loaded; above it, it is dropped."""
    bench = StreamBench(dut, 5)
    source = bench.source("i", [beat(20, 0), beat(3, 0), end()])
    sink = bench.sink("o")
    setup(dut)
    await bench.reset()
    seen = {}

    def observe():
        seen.update(told(dut))

    for _ in range(4):
        await bench.step(observe=observe)
    assert (source.sent, seen) == (0, {"finished": 0, "limit": LINES - 1, "front": 0})
    await bench.step(lambda: setattr(dut.oldest, "value", 5))
    for _ in range(4):
        await bench.step(observe=observe)
    assert (source.sent, seen["finished"], seen["front"]) == (3, 1, 5)
    assert sink.received == [beat(20, 0)], "line 3 had left"
    await bench.step(lambda: setattr(dut.restart, "value", 1))
    await bench.step(lambda: setattr(dut.restart, "value", 0), observe)
    assert seen == {"finished": 0, "limit": 0, "front": 1 - LINES}, "no line has come"


@cocotb.test()
async def nothing_is_read_outside_a_frame_or_unasked(dut):
    """Without a frame, or without the control bit, the stream is left alone."""
    for enable, active in ((0, 1), (1, 0), (0, 0)):
        bench = StreamBench(dut, 6)
        source = bench.source("i", [beat(0, 0), end()])
        sink = bench.sink("o")
        setup(dut, enable, active)
        await bench.reset()
        for _ in range(5):
            await bench.step()
        assert (source.sent, sink.received) == (0, [])
        assert int(dut.finished.value) == (not enable)


@pytest.mark.parametrize("config", [PAPER, SWIFT], ids=lambda config: config.name)
def test_loader_offers_words_as_their_lines_enter(block_simulator, config):
    run_bench(config, Loader, __file__, simulator_name=block_simulator)


@pytest.mark.thorough
def test_a_simulator_that_is_compiled_in_parts_runs_the_same(monkeypatch):
    """As those of large engines are, outside the tests."""
    monkeypatch.setattr(simulator, "MANY_CHARACTERS", 0)
    monkeypatch.setattr(simulator, "_IN_PARTS", ["--output-split", "300"])
    monkeypatch.delenv("SPLATLINE_QUICK_BUILD")
    built = simulator.build({"dut.v": convert(Loader(PAPER), "dut")}, "dut")
    assert len(list(built.folder.glob("Vtop___024root*.o"))) > 1
    simulator.run(built, Path(__file__))
