"""What is sent to an engine on its streams, and what must come of it: right or broken.

Each case takes a device, fresh or not, and leaves it ready for the next.
"""

import dataclasses

import numpy as np

from splatline.contract.raster_beats import from_beats, to_beats
from splatline.contract.register_map import register_map
from splatline.host.device.driver import Driver, Engine
from splatline.sim import golden
from tests.support import bus_words
from tests.support.bus_words import advance, any_words, block, decoded, end, word_bytes
from tests.support.random_frames import random_raster

__all__ = [
    "HEIGHT",
    "STREAMS",
    "WIDTH",
    "case",
    "clean",
    "draw_scene",
    "expect",
    "fresh",
    "initial_of",
    "right",
    "send",
    "setup",
]

WIDTH, HEIGHT = 48, 40
OKAY, SLVERR, DECERR = 0, 2, 3
STREAMS = {}


def clean(config, seed, count=60):
    return bus_words.clean(config, seed, count, WIDTH, HEIGHT)


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
    frame = bus_words.clean(engine.config, seed, 50, 37, 30)
    assert engine.errors() == []
    assert draw_scene(engine, frame).mismatches(golden.render(frame)) == 0
    assert not engine.get("STATUS", "BUSY")
    assert not engine.get("STATUS", "DROPPING")


def send(device, name, words, keep=None):
    """A packet of code words or beats; ``keep`` has a byte for each byte of it."""
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
    words += [advance(engine.config, HEIGHT + 4), element, frame.codewords[-1]]
    expect(device, frame, words, ["LINE_PAST"], drawn=words)
    # A step to the last line that an element can touch from is none.
    setup(device, 3)
    words = [advance(engine.config, HEIGHT + 3), element, element, frame.codewords[-1]]
    expect(device, frame, [element, *words], [], drawn=[element, *words])


@case(STREAMS)
def a_step_that_overflows(device):
    engine, frame = setup(device, 4)
    steps = [advance(engine.config, engine.config.x.mask)] * 9
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
    engine, frame = setup(device, 7)
    words = list(frame.codewords)
    keep = np.ones((len(words), word_bytes(engine.config)), np.uint8)
    # Many: a guard that lets them through is seen where the engine takes one and it shows.
    keep[3:-1:6, -1], keep[5:-1:6, 0], keep[7:-1:6] = 0, 0, 0
    drawn = [each for each, kept in zip(words, keep, strict=True) if kept.all()]
    expect(device, frame, words, ["PARTIAL_WORD"], drawn=drawn, keep=keep.tobytes())


@case(STREAMS)
def nothing_but_partial_words(device):
    """An empty frame, and two bits of ERROR."""
    engine, frame = setup(device, 8)
    keep = np.zeros((3, word_bytes(engine.config)), np.uint8)
    names = ["FRAME_ENDED_EARLY", "PARTIAL_WORD"]
    expect(
        device, frame, frame.codewords[:3], names,
        drawn=[end(engine.config)], keep=keep.tobytes(),
    )  # fmt: skip


@case(STREAMS)
def a_partial_end_word(device):
    engine, frame = setup(device, 8)
    keep = np.ones((len(frame.codewords), word_bytes(engine.config)), np.uint8)
    keep[-1, 4] = 0
    names = ["FRAME_ENDED_EARLY", "PARTIAL_WORD"]
    expect(device, frame, frame.codewords, names, keep=keep.tobytes())


@case(STREAMS)
def frames_of_nothing(device):
    engine, frame = setup(device, 9)
    words = [end(engine.config)]
    expect(device, frame, words, [], drawn=words)
    setup(device, 9)
    names = ["FRAME_ENDED_EARLY", "PARTIAL_WORD"]
    keep = bytes(word_bytes(engine.config))
    expect(device, frame, words, names, drawn=words, keep=keep)


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
    keep = np.ones((len(beats), Driver(device).get("CONFIG_1", "BEAT_BYTES")), np.uint8)
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
        words = any_words(rng, int(rng.integers(1, 60)), WIDTH, HEIGHT, config)
        words[rng.random(len(words)) < rng.choice([0.0, 0.05, 0.5])] = end(config)
        words = [*words, end(config)] if rng.random() < 0.5 else words
        words = np.array(words, np.uint64)
        present = rng.integers(0, 2, (len(words), word_bytes(config)))
        keep = np.where(rng.random((len(words), 1)) < 0.1, present, 1)
        sent.append((words, keep.astype(np.uint8)))
    engine.clear("ERROR")
    for words, keep in sent:
        picture, names = play(device, words, keep=keep.tobytes())
        kept = words[keep.all(axis=1)]
        taken = kept[: _first(decoded(kept, config)["end"]) + 1]
        whole = np.array([*taken, end(config)], np.uint64)
        expected = golden.render(dataclasses.replace(frame, codewords=whole))
        assert picture.mismatches(expected) == 0
        assert names == expected_errors(words, keep, config)
    right(device)


def _first(dirty_bits):
    """Index of the first that is set; past all if none is."""
    return int(np.argmax(dirty_bits)) if dirty_bits.any() else len(dirty_bits)


def expected_errors(words, keep, config):
    """What ERROR says of a packet: read from docs/registers.md, word by word."""
    names, y = set(), 0
    for n, (fields, kept) in enumerate(zip(decoded(words, config), keep, strict=True)):
        last = n == len(words) - 1
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
