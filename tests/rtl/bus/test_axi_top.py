"""The engine on its buses, driven by cocotbext-axi, against the golden renderer."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.presets import PAPER, PLANE, RGB24, SWIFT
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.contract.register_map import VERSION, register_map
from splatline.host.device.driver import Engine
from splatline.rtl.engine import engine_latency
from splatline.sim import golden
from splatline.sim.cosim.axi.axi_device import SimulatedDevice
from splatline.sim.cosim.axi.axi_frames import simulate_on_buses
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.bus import axi_abort_cases, axi_bus_cases, axi_cases
from tests.rtl.bus.axi_cases import (
    HEIGHT,
    WIDTH,
    clean,
    draw_scene,
    fresh,
    right,
    send,
    setup,
)
from tests.support import bus_words
from tests.support import plane_words as pw
from tests.support.bus_words import block, decoded, end
from tests.support.codewords import largest_tables, random_tables
from tests.support.random_frames import random_raster


def simulated(config):
    with SimulatedDevice(config, limit=20_000) as device:
        yield device


def after_reset(simulation):
    """The device after reset; at the end no rule of the buses has been broken."""
    fresh(simulation)
    yield simulation
    assert simulation.command("rules") == []


@pytest.fixture(scope="module")
def simulation():
    yield from simulated(PAPER)


@pytest.fixture
def device(simulation):
    yield from after_reset(simulation)


@pytest.fixture(scope="module")
def wide_simulation():
    yield from simulated(SWIFT)


@pytest.fixture
def wide_device(wide_simulation):
    """An engine with a window of blocks, whose beats have two words."""
    yield from after_reset(wide_simulation)


@pytest.fixture(scope="module")
def plane_simulation():
    yield from simulated(PLANE)


@pytest.fixture
def plane_device(plane_simulation):
    """An engine with planes, whose code words are 16 bytes."""
    yield from after_reset(plane_simulation)


STALLS = pytest.mark.parametrize("stall", [0.0, 0.3, 0.8])


def draw_frames(device, stall):
    """Frames are golden's, of which the second starts from a raster."""
    engine = Engine(device)
    device.command("stall", stall, 5)
    rng = np.random.default_rng(1)
    for seed, share in enumerate((None, 0.3, None)):
        frame = clean(engine.config, seed, 120)
        start = None if share is None else random_raster(rng, WIDTH, HEIGHT, share, engine.config)
        picture = draw_scene(engine, frame, start)
        assert picture.mismatches(golden.render(frame, start)) == 0
        assert picture.drawn.mean() > 0.2
    assert engine.counters()["frames"] == 3


@STALLS
def test_frames_are_golden_s_under_stalls_of_every_channel(device, stall):
    draw_frames(device, stall)


def test_frames_reach_every_column_and_line(device):
    """Marks of all memory words, the largest size, and tables of any bits."""
    engine = Engine(device)
    rng = np.random.default_rng(1)
    tables = [largest_tables(), *(random_tables(rng) for _ in range(3))]
    for seed, (lines, count) in enumerate([(64, 1500), (64, 1500), (1024, 200), (512, 200)]):
        frame = bus_words.clean(PAPER, seed, count, 512, lines)
        frame = dataclasses.replace(frame, tables=tables[seed])
        start = random_raster(rng, 512, lines, 0.002) if seed else None
        picture = draw_scene(engine, frame, start)
        assert picture.mismatches(golden.render(frame, start)) == 0
        assert picture.drawn.any(axis=0).mean() > 0.9
        assert picture.drawn[-16:].any()
    assert engine.errors() == []


def test_frames_of_plane_words_are_golden_s_under_stalls_of_every_channel(plane_device):
    assert Engine(plane_device).config is PLANE
    assert (codeword_stream_bytes(PLANE), raster_stream_bytes(PLANE)) == (16, 32)
    draw_frames(plane_device, 0.3)


def test_plane_words_of_any_bits_are_golden_s(plane_device):
    """Elements anywhere and at any depth, byte by byte of the picture's packets."""
    plane_device.command("stall", 0.2, 9)
    engine = Engine(plane_device)
    rng = np.random.default_rng(11)
    for _ in range(4):
        whole = pw.random_frame(rng, 300, (WIDTH, HEIGHT), PLANE)
        above = rng.integers(0, 1 << 32, len(whole.codewords), np.uint64) << np.uint64(32)
        whole.codewords[:, 1] |= above  # bits of the stream that mean nothing
        engine.write_tables(whole.tables, WIDTH, HEIGHT)
        engine.clear_counters()
        plane_device.send(whole.codewords)
        expected = to_beats(golden.render(whole))
        *drawn, last = plane_device.receive()
        assert np.array_equal(drawn, engine.widen(expected)[:-1])
        limb, bit = divmod(PLANE.raster_end.lsb, 64)
        assert int(last[limb]) >> bit == 1  # its other fields mean nothing
        control = decoded(whole.codewords, PLANE)["control"]
        assert engine.get("ELEMENTS") == np.count_nonzero(~control) > 250
        assert engine.get("WORDS") == len(expected) - 1 > 100
        engine.clear("ERROR")


@pytest.mark.parametrize(
    ("config", "beat_bytes", "words"),
    [
        # The driver knows no preset like the first, which has 6 bits a channel.
        pytest.param(
            PAPER.replace(channel_bits=6, pixels_per_word=8, coefficient_bits=12, colour_shift=12),
            *(32, 3),
            marks=pytest.mark.thorough,
        ),
        (RGB24, 32, 2),
    ],
    ids=["lanes", "rgb24"],
)
def test_an_engine_with_wider_beats_and_materials(config, beat_bytes, words):
    """Beats of 32 bytes, and materials of three and two words."""
    assert raster_stream_bytes(config) == beat_bytes
    frame = clean(config, 1, 30)
    start = random_raster(np.random.default_rng(1), WIDTH, HEIGHT, 0.02, config)
    with SimulatedDevice(config) as device:
        engine = Engine(device)
        assert engine.config == config
        assert engine.registers.materials.words == words
        picture = draw_scene(engine, frame, start)
        assert picture.mismatches(golden.render(frame, start)) == 0
        assert device.command("rules") == []


@pytest.mark.parametrize("which", ["device", "plane_device"])
def test_frames_that_press_behind_each_other(request, which):
    device = request.getfixturevalue(which)
    engine, frame = setup(device, 1)
    frames = [clean(engine.config, seed) for seed in range(4)]
    for each in frames:
        device.send(each.codewords)
    for each in frames:
        beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
        picture = from_beats(beats, WIDTH, HEIGHT, engine.config)
        expected = golden.render(dataclasses.replace(each, tables=frame.tables))
        assert picture.mismatches(expected) == 0
    assert engine.errors() == []


@pytest.mark.parametrize("stall", [0.0, 0.5])
@pytest.mark.parametrize("name", axi_cases.STREAMS)
def test_bad_streams(device, name, stall):
    device.command("stall", stall, 7)
    axi_cases.STREAMS[name](device)


def test_a_frame_from_an_initial_raster_on_a_window_of_blocks(wide_device):
    wide_device.command("stall", 0.3, 6)
    engine = Engine(wide_device)
    frame = clean(SWIFT, 1, 120)
    start = random_raster(np.random.default_rng(2), WIDTH, HEIGHT, 0.3, SWIFT)
    assert engine.config == SWIFT
    assert raster_stream_bytes(SWIFT) == 128
    assert draw_scene(engine, frame, start).mismatches(golden.render(frame, start)) == 0


@pytest.mark.parametrize(
    "name", [name for name in axi_cases.STREAMS if "initial" in name or "any_packets" in name]
)
def test_bad_beats_on_a_window_of_blocks(wide_device, name):
    """Code words pass the same guard as those of other engines; beats are wider."""
    wide_device.command("stall", 0.3, 7)
    axi_cases.STREAMS[name](wide_device)


@pytest.mark.parametrize("name", axi_cases.STREAMS)
def test_bad_streams_of_plane_words(plane_device, name):
    plane_device.command("stall", 0.3, 7)
    axi_cases.STREAMS[name](plane_device)


@pytest.mark.parametrize("name", axi_bus_cases.BUS)
def test_bad_accesses(device, name):
    axi_bus_cases.BUS[name](device)


@pytest.mark.parametrize("name", axi_bus_cases.BUS)
def test_bad_accesses_of_an_engine_with_planes(plane_device, name):
    axi_bus_cases.BUS[name](plane_device)


@pytest.mark.parametrize("name", axi_abort_cases.ABORTS)
def test_a_frame_is_aborted(device, name):
    axi_abort_cases.ABORTS[name](device)


@pytest.mark.parametrize("name", axi_abort_cases.ABORTS)
def test_a_frame_of_plane_words_is_aborted(plane_device, name):
    axi_abort_cases.ABORTS[name](plane_device)


@pytest.mark.parametrize("which", ["device", "plane_device"])
def test_a_reset_in_mid_frame(request, which):
    device = request.getfixturevalue(which)
    for wait in (10, 60, 300):
        engine, frame = setup(device, wait)
        device.send(frame.codewords)
        device.command("wait", wait)
        assert engine.get("FRAMES") == 0
        device.command("reset")
        right(device)
        fresh(device)


def test_the_first_frame_after_a_reset_counts_the_clearing(simulation):
    """The engine opens the frame at once, and its elements wait until the window is cleared."""
    simulation.command("stall", 0.0, 0)
    simulation.command("reset")
    engine = Engine(simulation)
    words = [block(PAPER, 9)] * 9 + [end(PAPER)]
    counts = []
    for _ in range(2):
        send(simulation, "codewords", words)
        simulation.receive()
        counts.append([engine.get(name) for name in ("CYCLES", "INPUT_STALLS")])
    first, both = np.array(counts)
    longer = first - (both - first)
    assert (longer > 300).all()
    assert (longer < PAPER.clear_cycles).all()


@pytest.mark.parametrize("which", ["simulation", "plane_simulation"])
def test_registers_read_as_their_description_says_after_reset(request, which):
    simulation = request.getfixturevalue(which)
    simulation.command("reset")
    registers = register_map(simulation.config)
    for register in registers.registers:
        if register.readable:
            value = sum(f.reset << f.place.lsb for f in register.fields if f.access.readable)
            assert simulation.command("read", register.offset) == (value, 0), register.name


def test_reads_and_writes_at_once(device):
    """Each channel stalls apart; reads and writes keep their own order."""
    registers = Engine(device).registers
    column, line = registers["LAST_COLUMN"].offset, registers["LAST_LINE"].offset
    device.command("stall", 0.4, 3)
    values = [int(value) for value in np.random.default_rng(3).integers(0, 512, 40)]
    identity = registers["ID"].offset
    reads = [identity, registers["VERSION"].offset] * 20
    writes = [(column if n % 2 else line, value.to_bytes(4, "little"))
              for n, value in enumerate(values)]  # fmt: skip
    read, written = device.command("together", reads, writes)
    version = VERSION[0] << 8 | VERSION[1]
    assert read == [(0x53504C54, 0), (version, 0)] * 20
    assert written == [0] * 40
    assert (device.read32(line), device.read32(column)) == tuple(values[-2:])


@pytest.mark.parametrize("which", ["device", "plane_device"])
def test_the_counters_say_what_was_sent(request, which):
    device = request.getfixturevalue(which)
    engine, frame = setup(device, 3, 100)
    engine.clear_counters()
    device.command("raster_cycles")
    device.command("watch_engine")
    assert not any(engine.counters().values())
    device.command("stall", 0.5, 4)
    beats = sum(len(engine.draw_beats(frame.codewords)) for _ in range(2))
    device.command("stall", 0.0, 0)
    counters = engine.counters()
    taken, waited = device.command("raster_cycles")
    cycles, input_stalls = device.command("engine_cycles")
    elements = int((~decoded(frame.codewords, engine.config)["control"]).sum())
    assert counters["frames"] == 2
    assert counters["elements"] == 2 * elements > 100
    assert counters["words"] == beats - 2 == taken - 2
    assert counters["output_stalls"] == waited > 100
    assert counters["cycles"] == cycles > 2 * len(frame.codewords)
    assert counters["input_stalls"] == input_stalls > 100


def test_cycles_of_a_frame_of_nothing(device):
    """The figure of the engine by itself: the buses add none."""
    engine, frame = setup(device, 4)
    engine.clear_counters()
    engine.draw(frame.codewords[-1:])
    assert engine.counters()["cycles"] == engine_latency(PAPER) + 2
    assert engine.counters()["input_stalls"] == 0


def test_a_held_frame_waits_and_tables_are_taken_meanwhile(device):
    engine, frame = setup(device, 5)
    other = clean(PAPER, 6)
    engine.set("CONTROL", QUIET=1, HOLD=1)
    device.send(frame.codewords)
    device.command("wait", 300)
    assert not engine.get("STATUS", "BUSY")
    engine.write_tables(other.tables, WIDTH, HEIGHT)
    engine.set("CONTROL", QUIET=1)
    picture = from_beats(device.receive()[:, :2], WIDTH, HEIGHT)
    expected = golden.render(frame.__class__(frame.codewords, other.tables, WIDTH, HEIGHT))
    assert picture.mismatches(expected) == 0


def interrupt(device):
    """It follows its cause by a cycle, and an answer on the bus does not wait for it."""
    device.command("wait", 2)
    return device.command("irq")


@pytest.mark.parametrize("which", ["device", "plane_device"])
def test_interrupts(request, which):
    device = request.getfixturevalue(which)
    engine, frame = setup(device, 7)
    engine.set("IRQ_STATUS", FRAME_DONE=1)
    engine.draw(frame.codewords)
    assert engine.get("IRQ_STATUS", "FRAME_DONE")
    assert interrupt(device) == 0
    engine.set("IRQ_ENABLE", FRAME_DONE=1)
    assert interrupt(device) == 1
    engine.set("IRQ_STATUS", FRAME_DONE=1)
    assert interrupt(device) == 0
    engine.set("IRQ_ENABLE", ERROR=1)
    device.send(frame.codewords[:-1])
    device.receive()
    assert interrupt(device) == 1
    engine.set("ERROR", FRAME_ENDED_EARLY=1)
    assert interrupt(device) == 0


@pytest.mark.parametrize("config", [PAPER, PLANE], ids=lambda config: config.name)
def test_a_frame_the_driver_s_way_as_render_has_it(config):
    frame = clean(config, 9, 40)
    told = []
    outcome = simulate_on_buses(
        frame, stall=0.2, seed=2, progress=lambda *stage: told.append(stage)
    )
    assert outcome.raster.mismatches(golden.render(frame)) == 0
    shares = [share for stage, share in told if stage == "run"]
    assert shares == sorted(shares)
    assert shares[0] == 0.0 < shares[-1] <= 1.0
    assert len(frame.codewords) < outcome.cycles < 20_000
    early = dataclasses.replace(frame, codewords=frame.codewords[:-1])
    with pytest.raises(SimulationError, match="FRAME_ENDED_EARLY"):
        simulate_on_buses(early)


def test_a_simulator_that_stops_is_told_with_its_log():
    with SimulatedDevice(PAPER) as device, pytest.raises(SimulationError, match="no_such_method"):
        device.command("no_such_method")


def test_a_stall_that_would_never_end_is_refused():
    with pytest.raises(ValueError, match="stall must be"):
        SimulatedDevice(PAPER, stall=1.0)
