"""What is done to an engine on its buses, and what must come of it; on a right engine or a broken.

Each case takes a device, fresh or not, and leaves it ready for the next.
"""

import dataclasses

import numpy as np
from random_frames import nonsense, random_raster, shapes, word

from splatline.host.device import DeviceTimeoutError
from splatline.host.driver import Driver, EngineError
from splatline.host.order import advance_word, end_word
from splatline.rtl.register_map import register_map
from splatline.sim import golden
from splatline.sim.beats import from_beats, to_beats
from splatline.sim.driver import Engine

__all__ = ["ABORTS", "BUS", "STREAMS", "draw_scene", "fresh", "inside", "right"]

WIDTH, HEIGHT = 48, 40
OKAY, SLVERR, DECERR = 0, 2, 3
STREAMS, BUS, ABORTS = {}, {}, {}


def inside(frame):
    """A frame without the elements that lie beyond the last column."""
    words = golden.decode(frame.codewords, frame.config)
    kept = words["control"] | (words["x"] < frame.width)
    return dataclasses.replace(frame, codewords=frame.codewords[kept])


def clean(config, seed, count=60):
    return inside(shapes(np.random.default_rng(seed), count, WIDTH, HEIGHT, config=config))


def draw_scene(engine, frame, initial=None):
    """What a user writes: the same for a simulation and a board."""
    engine.write_tables(frame.tables, frame.width, frame.height)
    return engine.draw(frame.codewords, initial)


def fresh(device):
    """An engine after reset, and the window's memory cleared."""
    device.command("stall", 0.0, 0)
    device.command("reset")
    device.command("wait", 600)
    return Engine(device)


def right(device, seed=99):
    """The next frame is right, of another size and with other tables, and there are no errors."""
    engine = Engine(device)
    frame = inside(shapes(np.random.default_rng(seed), 50, 37, 30, config=engine.config))
    assert engine.errors() == []
    assert draw_scene(engine, frame).mismatches(golden.render(frame)) == 0
    assert not engine.get("STATUS", "BUSY")
    assert not engine.get("STATUS", "DROPPING")


def send(device, name, words, keep=None):
    """A packet of words of 64 bits or beats; ``keep`` has a byte for each byte of it."""
    device.command("send", name, np.ascontiguousarray(words).astype("<u8").tobytes(), keep)


def play(device, words, *, keep=None, initial=None, initial_keep=None, size=(WIDTH, HEIGHT)):
    """The picture of a packet, and what ERROR says of it."""
    engine = Engine(device)
    engine.clear("ERROR")
    engine.set("START", LOAD=int(initial is not None))
    if initial is not None:
        send(device, "initial", engine.widen(initial), initial_keep)
    send(device, "codewords", np.array(words, np.uint64), keep)
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    names = engine.errors()
    engine.clear("ERROR")
    return from_beats(beats, *size, engine.config), names


def block(config, x):
    """An element of 8 x 8 pixels."""
    return word([(0, 7)] * 4, x, 1, mode=0, config=config)


def case(table):
    """Enter a function in a table of cases."""

    def enter(function):
        table[function.__name__] = function
        return function

    return enter


def setup(device, seed, count=60):
    """An engine with tables and size, and a frame for them."""
    engine = Engine(device)
    frame = clean(engine.config, seed, count)
    engine.write_tables(frame.tables, WIDTH, HEIGHT)
    return engine, frame


def expect(device, frame, words, names, *, drawn=None, initial=None, start=None, **sent):
    """A packet draws what golden draws of ``drawn``, and ERROR has those names."""
    picture, found = play(device, words, initial=initial, **sent)
    whole = frame.codewords if drawn is None else np.array(drawn, np.uint64)
    expected = golden.render(dataclasses.replace(frame, codewords=whole), start)
    assert found == names
    assert picture.mismatches(expected) == 0
    assert expected.drawn.any() or len(whole) == 1
    right(device)


@case(STREAMS)
def an_element_beyond_the_last_column(device):
    engine, frame = setup(device, 1)
    columns = (WIDTH, WIDTH + 5, engine.config.x.mask)
    words = [*(block(engine.config, x) for x in columns), *frame.codewords]
    expect(device, frame, words, ["X_OUTSIDE"], drawn=words)


@case(STREAMS)
def an_element_in_the_last_column(device):
    engine, frame = setup(device, 2)
    words = [block(engine.config, WIDTH - 1), *frame.codewords]
    expect(device, frame, words, [], drawn=words)


@case(STREAMS)
def steps_past_the_frame(device):
    engine, frame = setup(device, 3)
    element = block(engine.config, 9)
    words = [*frame.codewords[:-1]]
    words += [advance_word(HEIGHT + 5, engine.config), element, frame.codewords[-1]]
    expect(device, frame, words, ["LINE_PAST"], drawn=words)
    # A step to the last line that an element can touch from is none.
    setup(device, 3)
    words = [advance_word(HEIGHT + 3, engine.config), element, element, frame.codewords[-1]]
    expect(device, frame, [element, *words], [], drawn=[element, *words])


@case(STREAMS)
def a_step_that_overflows(device):
    engine, frame = setup(device, 4)
    steps = [advance_word(engine.config.x.mask, engine.config)] * 9
    words = [*frame.codewords[:-1], *steps, *frame.codewords[:20], frame.codewords[-1]]
    expect(device, frame, words, ["LINE_PAST"], drawn=words)


@case(STREAMS)
def a_frame_that_ends_early(device):
    _, frame = setup(device, 5)
    expect(device, frame, frame.codewords[:-1], ["FRAME_ENDED_EARLY"])


@case(STREAMS)
def an_end_word_without_last(device):
    _, frame = setup(device, 6)
    words = [*frame.codewords, *frame.codewords[:30], *frame.codewords]
    expect(device, frame, words, ["END_WITHOUT_LAST"])


@case(STREAMS)
def partial_words(device):
    _, frame = setup(device, 7)
    words = list(frame.codewords)
    keep = np.ones((len(words), 8), np.uint8)
    keep[3, 7], keep[9, 0], keep[20] = 0, 0, 0
    drawn = [each for n, each in enumerate(words) if n not in (3, 9, 20)]
    expect(device, frame, words, ["PARTIAL_WORD"], drawn=drawn, keep=keep.tobytes())


@case(STREAMS)
def a_partial_end_word(device):
    _, frame = setup(device, 8)
    keep = np.ones((len(frame.codewords), 8), np.uint8)
    keep[-1, 4] = 0
    names = ["FRAME_ENDED_EARLY", "PARTIAL_WORD"]
    expect(device, frame, frame.codewords, names, keep=keep.tobytes())


@case(STREAMS)
def frames_of_nothing(device):
    engine, frame = setup(device, 9)
    end = [end_word(engine.config)]
    expect(device, frame, end, [], drawn=end)
    setup(device, 9)
    names = ["FRAME_ENDED_EARLY", "PARTIAL_WORD"]
    expect(device, frame, end, names, drawn=end, keep=bytes(8))


def initial_of(frame, seed):
    picture = random_raster(np.random.default_rng(seed), WIDTH, HEIGHT, 0.3, frame.config)
    return picture, to_beats(picture)


@case(STREAMS)
def an_initial_raster_that_ends_early(device):
    _, frame = setup(device, 10)
    start, beats = initial_of(frame, 1)
    names = ["INITIAL_ENDED_EARLY"]
    expect(device, frame, frame.codewords, names, initial=beats[:-1], start=start)


@case(STREAMS)
def an_initial_raster_whose_end_is_not_last(device):
    _, frame = setup(device, 11)
    start, beats = initial_of(frame, 2)
    _, others = initial_of(frame, 3)
    sent = np.concatenate([beats, others])
    names = ["INITIAL_WITHOUT_LAST"]
    expect(device, frame, frame.codewords, names, initial=sent, start=start)


@case(STREAMS)
def a_partial_beat_of_an_initial_raster(device):
    _, frame = setup(device, 12)
    start, beats = initial_of(frame, 4)
    keep = np.ones((len(beats), 8 * Driver(device).get("CONFIG_1", "BEAT_BYTES") // 8), np.uint8)
    keep[5, 3] = 0
    start = from_beats(np.delete(beats, 5, axis=0), WIDTH, HEIGHT, frame.config)
    expect(
        device, frame, frame.codewords, ["INITIAL_PARTIAL"],
        initial=beats, initial_keep=keep.tobytes(), start=start,
    )  # fmt: skip


@case(STREAMS)
def an_initial_raster_that_nobody_asked_for(device):
    """It waits for a frame that loads."""
    engine, frame = setup(device, 13)
    start, beats = initial_of(frame, 5)
    send(device, "initial", engine.widen(beats))
    expect(device, frame, frame.codewords, [])
    engine, frame = setup(device, 13)
    engine.set("START", LOAD=1)
    picture = from_beats(engine_draw(engine, frame.codewords), WIDTH, HEIGHT, engine.config)
    assert picture.mismatches(golden.render(frame, start)) == 0
    right(device)


def engine_draw(engine, words):
    """Beats of a frame, with the registers as they are."""
    engine.device.send(words)
    return engine.device.receive()[:, : -(-engine.config.raster_end.end // 64)]


@case(STREAMS)
def any_packets_at_all(device):
    """Random bits, sizes of words, ends and lengths: each packet is answered by its own picture."""
    rng = np.random.default_rng(14)
    engine, frame = setup(device, 14)
    config = engine.config
    sent = []
    for _ in range(12):
        words = nonsense(rng, int(rng.integers(1, 60)), WIDTH, HEIGHT, config=config).codewords
        words[rng.random(len(words)) < rng.choice([0.0, 0.05, 0.5])] = end_word(config)
        words = words if rng.random() < 0.5 else words[:-1]
        keep = np.where(rng.random((len(words), 1)) < 0.1, rng.integers(0, 2, (len(words), 8)), 1)
        sent.append((words, keep.astype(np.uint8)))
    sent = [(words, keep) for words, keep in sent if len(words)]
    engine.clear("ERROR")
    for words, keep in sent:
        picture, names = play(device, words, keep=keep.tobytes())
        kept = words[keep.all(axis=1)]
        taken = kept[: _first(golden.decode(kept, config)["end"]) + 1]
        whole = np.array([*taken, end_word(config)], np.uint64)
        expected = golden.render(dataclasses.replace(frame, codewords=whole))
        assert picture.mismatches(expected) == 0
        assert names == expected_errors(words, keep, config)
    right(device)


def _first(marks):
    """Index of the first that is set; past all if none is."""
    return int(np.argmax(marks)) if marks.any() else len(marks)


def expected_errors(words, keep, config):
    """What ERROR says of a packet: read from docs/registers.md, word by word."""
    names, y = set(), 0
    for n, (each, kept) in enumerate(zip(words, keep, strict=True)):
        last = n == len(words) - 1
        (fields,) = golden.decode(np.array([each], np.uint64), config)
        if not kept.all():
            names |= {"PARTIAL_WORD"} | ({"FRAME_ENDED_EARLY"} if last else set())
            continue
        if fields["end"]:
            names |= set() if last else {"END_WITHOUT_LAST"}
            break
        if fields["control"]:
            y += int(fields["x"])
            names |= {"LINE_PAST"} if y - 4 > HEIGHT - 1 else set()
        elif fields["x"] >= WIDTH:
            names |= {"X_OUTSIDE"}
        names |= {"FRAME_ENDED_EARLY"} if last else set()
    order = [field.name for field in register_map(config)["ERROR"].fields]
    return sorted(names, key=order.index)


def refused(device, response, name, offset, data=None):
    """A read, or a write of bytes, is refused, and the bit says so; nothing else is told."""
    engine = Driver(device)
    engine.set("CONTROL")  # not quiet
    for answer in (response, OKAY):
        if data is None:
            assert device.command("read", offset) == (0, answer)
        else:
            assert device.command("write", offset, data) == answer
        assert engine.errors() == [name]
        engine.set("ERROR", **{name: 1})
        assert engine.errors() == []
        engine.set("CONTROL", QUIET=1)  # answered OKAY, and told all the same


def bytes_of(value):
    return value.to_bytes(4, "little")


@case(BUS)
def nothing_at_an_address(device):
    registers = Driver(device).registers
    beyond = registers.registers[-1].offset + 4
    window = registers.materials
    offsets = [beyond, 0x80, 0x1000, 0x1FFC, window.offset + window.entries * window.stride, 0x3FFC]
    offsets += [window.offset + 4 * n for n in range(window.words, window.stride // 4)]
    for offset in offsets:
        refused(device, DECERR, "BUS_ADDRESS", offset)
        refused(device, DECERR, "BUS_ADDRESS", offset, bytes_of(0))
    right(device)


@case(BUS)
def writes_of_what_is_read_only(device):
    registers = Driver(device).registers
    for register in registers.registers:
        if not register.writable:
            refused(device, SLVERR, "BUS_ACCESS", register.offset, bytes_of(0))
    right(device)


@case(BUS)
def reads_of_what_is_written_only(device):
    registers = Driver(device).registers
    for offset in (registers["AMBIENT_RED"].offset, registers.materials.offset + 8):
        refused(device, SLVERR, "BUS_ACCESS", offset)
    right(device)


@case(BUS)
def writes_of_some_bytes(device):
    registers = Driver(device).registers
    before = device.read32(registers["LAST_LINE"].offset)
    for register in ("LAST_LINE", "CONTROL", "AMBIENT_RED"):
        offset = registers[register].offset
        refused(device, SLVERR, "BUS_STROBE", offset, b"\x01")
        refused(device, SLVERR, "BUS_STROBE", offset + 1, b"\x00\x00\x00")
    refused(device, SLVERR, "BUS_STROBE", registers.materials.offset, b"\x01\x02")
    assert device.read32(registers["LAST_LINE"].offset) == before
    right(device)


@case(BUS)
def bits_that_a_register_lacks(device):
    registers = Driver(device).registers
    for register in registers.registers:
        if register.writable and register.name != "CONTROL":
            lacking = 1 << register.writable.bit_length()
            before = register.readable and device.read32(register.offset)
            refused(device, SLVERR, "BUS_VALUE", register.offset, bytes_of(lacking))
            assert before == (register.readable and device.read32(register.offset))
    window = registers.materials
    if window.writable[-1] != 0xFFFF_FFFF:
        last = window.offset + 4 * (window.words - 1)
        refused(device, SLVERR, "BUS_VALUE", last, bytes_of(window.writable[-1] + 1))
    right(device)


@case(BUS)
def tables_written_in_mid_frame(device):
    """Refused, and changing nothing: neither of this frame nor of the next with the same tables."""
    engine, frame = setup(device, 20)
    device.command("pause", "raster", True)
    device.send(frame.codewords)
    device.command("wait", 200)
    assert engine.get("STATUS", "BUSY")
    window = engine.registers.materials
    offsets = [r.offset for r in engine.registers.registers if r.between_frames]
    offsets += [window.offset + 4 * n for n in range(2 * window.words)]
    assert len(offsets) > 8
    for offset in offsets:
        refused(device, SLVERR, "BUS_BUSY", offset, bytes_of(1))
    device.command("pause", "raster", False)
    expected = golden.render(frame)
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    assert from_beats(beats, WIDTH, HEIGHT, engine.config).mismatches(expected) == 0
    assert engine.draw(frame.codewords).mismatches(expected) == 0
    right(device)


@case(BUS)
def a_frame_is_open_behind_others_that_wait(device):
    """End beats wait to be taken, and behind them a frame that has been read but not sent."""
    engine, frame = setup(device, 22)
    device.command("pause", "raster", True)
    end = [end_word(engine.config)]
    blocks = np.array([*(block(engine.config, 9 * n) for n in range(5)), *end], np.uint64)
    for words in (end, end, end, blocks):
        send(device, "codewords", words)
    device.command("wait", 400)
    device.command("pause", "raster", False)
    device.command("wait", 5)
    device.command("pause", "raster", True)
    device.command("wait", 200)
    assert engine.get("FRAMES") % 4 == 3
    assert engine.get("STATUS", "BUSY")
    refused(device, SLVERR, "BUS_BUSY", engine.registers["LAST_LINE"].offset, bytes_of(1))
    device.command("pause", "raster", False)
    for _ in range(3):
        assert len(device.receive()) == 1
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    expected = golden.render(dataclasses.replace(frame, codewords=blocks))
    assert from_beats(beats, WIDTH, HEIGHT, engine.config).mismatches(expected) == 0
    right(device)


@case(BUS)
def nothing_passes_within_a_cycle(device):
    """Inputs turned over between two edges move no output, in whatever state of a frame."""
    engine, frame = setup(device, 21)
    start, beats = initial_of(frame, 8)
    engine.set("START", LOAD=1)
    device.command("stall", 0.3, 8)
    device.send(frame.codewords, engine.widen(beats))
    assert device.command("turn_over", 600) == []
    drawn = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    picture = from_beats(drawn, WIDTH, HEIGHT, engine.config)
    assert picture.mismatches(golden.render(frame, start)) == 0
    right(device)


def abort(device, frame, *, dropping=()):
    """End the frame that is open; the part of it that came is part of the picture."""
    engine = Driver(device)
    assert engine.get("STATUS", "BUSY")
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.command("pause", "raster", False)
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    from_beats(beats, WIDTH, HEIGHT, engine.config)  # inside the image and in order
    device.command("wait", 200)  # a word is dropped a cycle
    for bit in ("DROPPING", "DROPPING_INITIAL"):
        assert engine.get("STATUS", bit) == (bit in dropping)
    assert not engine.get("STATUS", "BUSY")
    assert "ABORTED" in engine.errors()
    engine.clear("ERROR")
    for stream in ("codewords", "initial"):
        device.command("pause", stream, False)
    device.command("wait", 2000)
    assert engine.errors() == []


@case(ABORTS)
def while_the_raster_waits(device):
    _, frame = setup(device, 30)
    device.command("pause", "raster", True)
    device.send(frame.codewords)
    device.command("wait", 200)
    abort(device, frame)
    right(device)


@case(ABORTS)
def in_the_middle_of_the_code_words(device):
    engine, frame = setup(device, 31)
    device.send(frame.codewords)
    device.command("wait", 40)
    device.command("pause", "codewords", True)
    device.command("wait", 400)
    assert engine.get("ELEMENTS") > 0
    abort(device, frame, dropping=["DROPPING"])
    right(device)


@case(ABORTS)
def with_an_initial_raster_that_never_comes(device):
    engine, frame = setup(device, 32)
    engine.set("START", LOAD=1)
    device.send(frame.codewords)
    device.command("wait", 400)
    abort(device, frame)
    right(device)


@case(ABORTS)
def in_the_middle_of_an_initial_raster(device):
    engine, frame = setup(device, 33)
    engine.set("START", LOAD=1)
    start, beats = initial_of(frame, 6)
    device.send(frame.codewords, engine.widen(beats))
    device.command("wait", 60)
    device.command("pause", "initial", True)
    device.command("wait", 400)
    abort(device, frame, dropping=["DROPPING_INITIAL"])
    engine, frame = setup(device, 33)
    assert engine.draw(frame.codewords, start).mismatches(golden.render(frame, start)) == 0
    right(device)


@case(ABORTS)
def while_the_engine_clears_its_memory(device):
    """And the initial raster will not come."""
    device.command("reset")
    engine = Driver(device)
    frame = clean(engine.config, 37)
    engine.set("START", LOAD=1)
    device.send(frame.codewords)
    device.command("wait", 20)
    assert engine.get("WORDS") == 0
    device.command("pause", "codewords", True)
    assert engine.get("STATUS", "BUSY")
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.receive()
    device.command("pause", "codewords", False)
    device.command("wait", 500)
    assert engine.errors() == ["ABORTED"]
    engine.set("ERROR", ABORTED=1)
    right(device)


@case(ABORTS)
def before_the_engine_has_a_word(device):
    """All that came was dropped; the end is its first, and asks for an initial raster."""
    engine, frame = setup(device, 39)
    engine.set("START", LOAD=1)
    engine.set("CONTROL", QUIET=1, CLEAR=1)
    keep = np.ones((len(frame.codewords), 8), np.uint8)
    keep[:60] = 0
    send(device, "codewords", frame.codewords, keep.tobytes())
    device.command("wait", 20)
    device.command("pause", "codewords", True)
    device.command("wait", 20)
    assert engine.get("CYCLES") == 0
    abort(device, frame, dropping=["DROPPING"])
    right(device)


@case(ABORTS)
def in_any_of_its_first_cycles(device):
    """One that comes before the frame does nothing; then the frame waits for its initial raster."""
    engine, frame = setup(device, 38)
    aborted = []
    for cycles in range(12):
        engine.set("START", LOAD=1)
        device.send(frame.codewords)
        if cycles:
            device.command("wait", cycles)
        engine.set("CONTROL", QUIET=1, ABORT=1)
        device.command("wait", 300)
        aborted.append(not engine.get("STATUS", "BUSY"))
        if not aborted[-1]:
            engine.set("CONTROL", QUIET=1, ABORT=1)
        beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
        from_beats(beats, WIDTH, HEIGHT, engine.config)
        device.command("wait", 200)
        assert engine.errors() == ["ABORTED"]
        engine.set("ERROR", ABORTED=1)
    assert len(set(aborted)) == 2, aborted
    right(device)


@case(ABORTS)
def between_frames(device):
    engine, frame = setup(device, 34)
    engine.set("CONTROL", QUIET=1, ABORT=1)
    assert engine.errors() == []
    assert engine.draw(frame.codewords).mismatches(golden.render(frame)) == 0
    right(device)


@case(ABORTS)
def and_then_the_host_s_dma_is_reset(device):
    """The rest of the packet will never come: RESYNC takes the next word as a frame's first."""
    engine, frame = setup(device, 35)
    device.send(frame.codewords)
    device.command("wait", 40)
    device.command("pause", "codewords", True)
    device.command("wait", 400)
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.receive()
    assert engine.get("STATUS", "DROPPING")
    device.command("forget", "codewords")
    device.command("pause", "codewords", False)
    engine.set("CONTROL", QUIET=1, RESYNC=1)
    assert not engine.get("STATUS", "DROPPING")
    engine.set("ERROR", ABORTED=1)
    right(device)


@case(ABORTS)
def by_the_driver_that_has_waited_too_long(device):
    engine, frame = setup(device, 36)
    engine.set("START", LOAD=1)
    limit, device.limit = device.limit, 3000
    device.command("pause", "initial", True)
    try:
        start, _ = initial_of(frame, 7)
        engine.draw(frame.codewords, start)
        raise AssertionError("a frame was drawn whose initial raster never came")
    except EngineError as error:
        assert error.names == ("ABORTED",)
        assert isinstance(error.__cause__, DeviceTimeoutError)
    finally:
        device.limit = limit
        device.command("forget", "initial")
        device.command("pause", "initial", False)
    right(device)
