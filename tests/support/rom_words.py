"""Words for the shape ROM, and a player that sends them through its Verilog."""

import json
from importlib import resources
from pathlib import Path

import numpy as np

from splatline.flow.verilog import convert
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.rtl.shapes.rom import ShapeRom
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.hex_words import read_hex, write_hex

__all__ = ["build_rom", "compact_words", "every_entry", "mixed_words", "play_words"]

PLAYER = Path(__file__).with_name("word_player.v")


def compact_words(config, size, level_x, level_y, part=0, rest=0):
    """Return compact words of arrays or numbers; ``rest``: value of the other fields."""
    values = np.broadcast_arrays(size, level_x, level_y, part)
    fields = (
        config.compact_size,
        config.compact_level_x,
        config.compact_level_y,
        config.compact_part,
    )
    words = np.asarray(rest, np.uint64) & np.uint64(~config_mask(config) & (1 << 64) - 1)
    words = words | np.uint64(1 << 21)
    for value, field in zip(values, fields, strict=True):
        words = words | value.astype(np.uint64) << np.uint64(field.lsb)
    return words


def config_mask(config):
    """Return the mask of MODE and SCANS."""
    return config.scans.mask << config.scans.lsb | 1


def every_entry(config, rng):
    """Return a word for each entry of a ROM: size, levels, and the four parts of sizes over 8."""
    largest = config.largest_shape
    grids = [np.indices((9, 64, 64, 1)).reshape(4, -1)]
    if largest > 8:
        size, x, y, part = np.indices((largest - 8, 64, 64, 4)).reshape(4, -1)
        grids.append(np.stack([size + 9, x, y, part]))
    size, x, y, part = np.concatenate(grids, axis=1)
    # In the left half of the widest image, so that no fraction begins outside it.
    rest = rng.integers(0, 1 << 64, len(size), np.uint64)
    rest &= np.uint64(~(1 << config.x.end - 1) & (1 << 64) - 1)
    return compact_words(config, size, x, y, part, rest)


def mixed_words(config, rng, count):
    """Return random words; half of them are compact words of any size."""
    words = rng.integers(0, 1 << 64, count, np.uint64)
    compact = rng.random(count) < 0.5
    words[compact] &= np.uint64(~(0b11111 << 20 | 1) & (1 << 64) - 1)
    words[compact] |= np.uint64(1 << 21)
    words[rng.random(count) < 0.05] = advance_word(3, config)
    return words


def build_rom(config, edit=None, simulator_name="verilator"):
    """Build the player with the ROM's Verilog, after ``edit``."""
    text = convert(ShapeRom(config), "dut")
    if edit is not None:
        changed = edit(text)
        assert changed != text
        text = changed
    sources = {"dut.v": text, PLAYER.name: PLAYER.read_text()}
    for name in ("stream_source.v", "stream_sink.v", "stream_check.v"):
        sources[name] = resources.files("splatline.sim.cosim.player").joinpath(name).read_text()
    return simulator.build(
        sources, "word_player", simulator=simulator_name, parameters={"END": end_word(config)}
    )


def play_words(built, streams, config, folder):
    """Send streams of words, each (words, rate in, rate out), through a built ROM, in one run.

    Return the words on its output and the cycles, for each stream.
    """
    end = np.array([end_word(config)], np.uint64)
    jobs = []
    for index, (words, rate_in, rate_out) in enumerate(streams):
        stream = np.concatenate([words, end])
        write_hex(folder / f"{index}.codewords", stream[:, np.newaxis], 64)
        slowest = min(rate_in, rate_out)
        rates = {"codeword": rate_in, "table": 1.0, "initial": 1.0, "raster": rate_out}
        jobs.append(
            {
                "seed": index + 1,
                "tables_first": 0,
                "table_frames": 0,
                "initial_waits": False,
                "frames": 1,
                "rates": {name: round(256 * rate) - 1 for name, rate in rates.items()},
                "most_cycles": int(5 * len(stream) / slowest) + 1000,
            }
        )
    (folder / "jobs.json").write_text(json.dumps(jobs))
    simulator.run(
        built,
        "splatline.sim.cosim.player.frame_bench",
        checks=False,
        plusargs=[f"+folder={folder}"],
        environment={"SPLATLINE_FOLDER": str(folder)},
    )
    reports = json.loads((folder / "outcomes.json").read_text())
    results = []
    for index, report in enumerate(reports):
        assert report["finished"], f"stream {index} did not end"
        assert (report["breaches"], report["stray"]) == (0, 0), report
        received = read_hex(folder / f"{index}.words", 64)[:, 0]
        assert received[-1] == end[0]
        results.append((received[:-1], report["cycles"]))
    return results
