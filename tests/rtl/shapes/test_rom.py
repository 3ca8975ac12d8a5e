"""The shape ROM's Verilog: every entry, what must pass untouched, stalls, and planted faults."""

import re

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.contract.variants import SHAPED
from splatline.host.encode.shape_table import EMPTY_SCANS, shape_table
from splatline.rtl.shapes.contents import shape_contents
from splatline.rtl.shapes.rom import ROM_LATENCY
from splatline.sim.cosim import simulator
from splatline.sim.golden.compact_words import expand
from tests.support.faults import fault
from tests.support.rom_words import build_rom, compact_words, every_entry, mixed_words, play_words

QUICKEST = "icarus" if simulator.available("icarus") else "verilator"
"""To build, for a few words: Verilator takes as long to build as Icarus for twenty thousand."""

RATES = [(1.0, 1.0), (0.6, 0.7), (1.0, 0.3), (0.2, 1.0)]

each_rom = pytest.mark.parametrize("config", SHAPED, ids=lambda config: config.name)


@each_rom
def test_every_entry_is_the_host_s_and_words_pass_in_order_under_stalls(config, tmp_path):
    rng = np.random.default_rng(1)
    entries = every_entry(config, rng)
    streams = [(entries, 1.0, 1.0)]
    streams += [(rng.permutation(entries)[:2000], *rates) for rates in RATES]
    streams += [(mixed_words(config, rng, 2000), *rates) for rates in RATES]
    quicker = "verilator" if config.largest_shape > 8 else QUICKEST
    played = play_words(build_rom(config, simulator_name=quicker), streams, config, tmp_path)
    for (words, *_), (received, _) in zip(streams, played, strict=True):
        assert np.array_equal(received, expand(words, config).words)

    # The entries once more, against the table itself and nothing else.
    received, cycles = played[0]
    scans = (received >> np.uint64(config.scans.lsb)).astype(np.int64) & config.scans.mask
    small = shape_table()[:9, ..., 0].ravel()
    assert np.array_equal(scans[: len(small)], small)
    large = entries[len(small) :]
    assert cycles == steps_of(entries, config) + 1 + ROM_LATENCY
    if config.largest_shape > 8:
        # Parts 0 and 1 are the table's upper half, with what is empty left out.
        origins = expand(entries, config).origins
        upper = np.concatenate(
            [np.zeros(len(small), np.int64), np.tile([1, 1, 0, 0], len(large) // 4)]
        )
        table = shape_table()[9:]
        assert np.array_equal(scans[upper[origins] == 1], table[table != EMPTY_SCANS])


def test_what_a_word_costs(tmp_path):
    """A cycle a word that comes out, or that gives none, and three from in to out."""
    _, config = SHAPED
    rng = np.random.default_rng(3)
    levels = np.arange(1000) % 64
    plain = np.full(1000, 0b011_001_011_001_011_001_011_001_1, np.uint64)
    border = plain | np.uint64(config.x.mask - 7 << config.x.lsb)
    both = compact_words(config, 16, 28 + levels % 8, 32, 1, rest=plain)
    # Thin and slanted: the outer lines have pixels on one side alone, or none.
    halves = [
        compact_words(config, 16, level, 55, part, rest=plain)
        for level in (8, 55)
        for part in (0, 3)
    ]
    nowhere = compact_words(config, 9, 0, 63, 0, rest=plain)
    streams = {
        "plain": (plain, 1000, 1000),
        "small": (compact_words(config, 8, levels, 9, rest=plain), 1000, 1000),
        "both": (both, 2000, 2000),
        **{f"one {n}": (words, 1000, 1000) for n, words in enumerate(halves)},
        "none": (nowhere, 0, 1000),
        "right of every image": (compact_words(config, 16, 32, 32, 1, border), 1000, 1000),
        "not held": (compact_words(config, 17, levels, 9, rest=plain), 0, 1000),
        "in turns": (np.stack([both, *halves, nowhere, plain]).T.ravel(), 7000, 8000),
    }
    mixed = mixed_words(config, rng, 3000), every_entry(config, rng)[-8000:]
    streams |= {
        f"mixed {n}": (words, len(expand(words, config).words), steps_of(words, config))
        for n, words in enumerate(mixed)
    }
    played = play_words(
        build_rom(config, simulator_name=QUICKEST),
        [(words, 1.0, 1.0) for words, *_ in streams.values()],
        config,
        tmp_path,
    )
    counts = [(len(words), cycles - ROM_LATENCY - 1) for words, cycles in played]
    assert dict(zip(streams, counts, strict=True)) == {
        name: (given, steps) for name, (_, given, steps) in streams.items()
    }


def steps_of(words, config):
    """The cycles of words at full rate, each of which gives 0, 1 or 2."""
    given = np.bincount(expand(words, config).origins, minlength=len(words))
    return int(np.maximum(given, 1).sum())


FAULTS = {
    "a number's lowest bit": (SHAPED[0], "numbers", 6 * 1024 - 700),
    "a shape's lowest bit": (SHAPED[0], "shapes", shape_contents(SHAPED[0]).numbers[4 * 1024]),
    "no mirror": (SHAPED[0], "mirror", None),
    "no mark": (SHAPED[0], "compact", None),
    "takes a word while the next waits": (SHAPED[0], "i__ready", None),
    "right fractions are lost": (SHAPED[1], "more", None),
    "empty left fractions are offered": (SHAPED[1], "has_left", None),
}


@pytest.mark.planted
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_noticed(name, tmp_path):
    config, signal, place = FAULTS[name]
    rng = np.random.default_rng(2)
    # A bit of a memory shows in few entries.
    words = rng.permutation(every_entry(config, rng))[: 2000 if place is None else None]
    built = build_rom(config, broken(signal, place), QUICKEST)
    try:
        [(received, _)] = play_words(built, [(words, 0.9, 0.6)], config, tmp_path)
    except AssertionError:
        return
    assert not np.array_equal(received, expand(words, config).words)


def broken(signal, place):
    """An edit of one bit of a memory, or of a signal."""
    if place is None:
        return fault("dut", signal, "1'h1" if signal in ("i__ready", "has_left") else "1'h0")

    def edit(text):
        digits = rf"({signal}\[{place}\] = \d+'h[0-9a-f]*)([0-9a-f]);"
        changed, count = re.subn(
            digits, lambda found: f"{found[1]}{int(found[2], 16) ^ 1:x};", text
        )
        assert count == 1
        return changed

    return edit


def test_an_engine_without_shapes_has_no_rom():
    with pytest.raises(ValueError, match="no shape ROM"):
        shape_contents(PAPER)
