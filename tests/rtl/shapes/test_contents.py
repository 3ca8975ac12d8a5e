"""The table that the ROM is made of, its compression, and what the tools keep of it."""

import json
import re

import numpy as np
import pytest

from splatline.contract.variants import SHAPED
from splatline.flow.area.synth import COMMAND, KINDS
from splatline.flow.memory_files import move_contents
from splatline.flow.netlist import WRITE_EDIF
from splatline.flow.tools import run_yosys
from splatline.flow.verilog import convert
from splatline.host.encode.shape_table import EMPTY_SCANS, shape_table
from splatline.rtl.shapes.contents import shape_contents
from splatline.rtl.shapes.rom import ShapeRom
from splatline.rtl.shapes.table import EMPTY, folded_shapes
from splatline.sim.cosim import simulator
from splatline.sim.golden.compact_words import expand
from tests.support.rom_words import build_rom, every_entry, play_words


def mirrored(entries):
    """Entries of the table from right to left: rows, and where there are two halves, these too."""
    swapped = np.zeros_like(entries)
    for row in range(4):
        first, last = entries >> 6 * row & 7, entries >> 6 * row + 3 & 7
        swapped |= np.where(first <= last, (7 - last) | (7 - first) << 3, 1) << 6 * row
    swapped[9:] = swapped[9:][..., [1, 0, 3, 2]]
    return swapped


def test_the_folded_integers_are_the_host_s_whole_table():
    """All 69,632 entries, from a quarter of them and two symmetries."""
    quarter = folded_shapes()
    unfolded = np.empty((17, 64, 64, 4), np.int64)
    unfolded[:, 32:, 32:] = quarter
    unfolded[:, :32, :32] = quarter[:, ::-1, ::-1]
    unfolded[:, 32:, :32] = mirrored(quarter)[:, :, ::-1]
    unfolded[:, :32, 32:] = mirrored(quarter)[:, ::-1]
    assert EMPTY == EMPTY_SCANS
    assert np.array_equal(unfolded, shape_table())


@pytest.mark.parametrize(("config", "rows", "shapes"), [(SHAPED[0], 6, 292), (SHAPED[1], 19, 1220)])
def test_each_shape_stands_once(config, rows, shapes):
    contents = shape_contents(config)
    assert len(contents.numbers) == 1024 * rows
    assert len(contents.shapes) - 1 == shapes == len(set(contents.shapes[1:]))
    assert max(contents.numbers) >> contents.word_bits == 0
    assert max(contents.shapes) >> contents.shape_bits == 0
    # Each is used, by some entry of some size; 0 by fractions without pixels.
    bits = contents.number_bits
    sides = [np.array(contents.numbers) >> bits * side for side in range(contents.abreast)]
    numbers = np.stack(sides, axis=1) & (1 << bits) - 1
    packed = numbers[-1024:, -1].copy()
    numbers[-1024:, -1] = packed & 7
    used = {*numbers.ravel().tolist(), *(packed >> 3 & 7).tolist(), *(packed >> 6 & 7).tolist()}
    assert used == set(range(config is SHAPED[0], shapes + 1))


@pytest.fixture
def verilog():
    """The small ROM's Verilog."""
    return convert(ShapeRom(SHAPED[0]), "dut")


def written(text, folder, named):
    """The Verilog with its contents in files of a folder, which it names so."""
    changed, files = move_contents(text, named)
    assert sorted(files) == ["numbers.hex", "shapes.hex"]
    for name, words in files.items():
        (folder / name).write_text(words)
    return changed


def test_yosys_keeps_the_contents_in_four_block_rams(verilog, tmp_path):
    """Bit for bit in the cells' INIT, and in EDIF.

    From files, which Yosys reads in a third of the time: that the text holds the same is what the
    simulations of both show.
    """
    (tmp_path / "rom.v").write_text(written(verilog, tmp_path, "."))
    script = f"read_verilog rom.v; {COMMAND} -flatten -top dut; {WRITE_EDIF} rom.edif; "
    script += "write_json rom.json"
    run_yosys(script, tmp_path)
    cells = json.loads((tmp_path / "rom.json").read_text())["modules"]["dut"]["cells"]
    rams = {name: cell for name, cell in cells.items() if cell["type"] in KINDS["bram"]}
    assert sorted(rams) == ["numbers.0.0", "numbers.0.1", "numbers.0.2", "shapes.0.0"]
    contents = shape_contents(SHAPED[0])
    numbers = np.concatenate([stored(rams[f"numbers.0.{n}"], 1) for n in range(3)])
    assert np.array_equal(numbers, columns(contents.numbers, 9))
    # Columns of bits that are the same in every word became wires.
    shapes = columns(contents.shapes, contents.shape_bits)
    shapes = shapes[:, shapes.any(axis=0) & ~shapes.all(axis=0)]
    kept = stored(rams["shapes.0.0"], 4)
    assert np.array_equal(kept[: len(shapes), : shapes.shape[1]], shapes)
    # What the vendor's tools read has the very same strings.
    written_out = contents_in_edif((tmp_path / "rom.edif").read_text())
    assert {name: written_out.get(name) for name in rams} == {
        name: {
            kind: int(bits.replace("x", "0"), 2)
            for kind, bits in cell["parameters"].items()
            if CONTENTS.match(kind)
        }
        for name, cell in rams.items()
    }


CONTENTS = re.compile(r"INITP?_[0-9A-F]{2}")
"""Parameters of a RAMB16 that have its contents."""


def contents_in_edif(text):
    """The INIT and INITP of each instance whose name is not its own in EDIF, as numbers."""
    found = {}
    for instance in re.split(r"\(instance ", text)[1:]:
        name = re.match(r'\(rename \w+ "([^"]+)"\)', instance)
        rows = re.findall(
            rf"""\(property ({CONTENTS.pattern}) \(string "256'h([0-9a-f]{{64}})"\)""", instance
        )
        if name and rows:
            found[name[1]] = {kind: int(digits, 16) for kind, digits in rows}
    return found


def columns(words, bits):
    """Words as rows of bits, the lowest first."""
    return np.array(words)[:, np.newaxis] >> np.arange(bits) & 1 == 1


def stored(cell, parts):
    """The words of a RAMB16 as rows of bits: each byte of INIT with its bit of INITP above it."""

    def bits(kind, count):
        rows = (cell["parameters"][f"{kind}_{n:02X}"][::-1] for n in range(count))
        return np.array(list("".join(rows))) == "1"

    data, parity = bits("INIT", 64).reshape(-1, 8), bits("INITP", 8).reshape(-1, 1)
    return np.concatenate([data, parity], axis=1).reshape(-1, 9 * parts)


def test_verilog_that_reads_files_does_the_same(tmp_path):
    config = SHAPED[0]
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    built = build_rom(config, lambda text: written(text, tmp_path, tmp_path.as_posix()), quickest)
    rng = np.random.default_rng(4)
    words = rng.permutation(every_entry(config, rng))[:5000]
    [(received, _)] = play_words(built, [(words, 1.0, 1.0)], config, tmp_path)
    assert np.array_equal(received, expand(words, config).words)


def test_memories_of_zeros_keep_their_text():
    memory = (
        "  reg [1:0] ram [1:0];\n  initial begin\n    ram[0] = 2'h{};\n    ram[1] = 2'h0;\n  end\n"
    )
    assert move_contents(memory.format(0), "x") == (memory.format(0), {})
    text, files = move_contents(memory.format(3), "x/y")
    assert text == '  reg [1:0] ram [1:0];\n  initial $readmemh("x/y/ram.hex", ram);\n'
    assert files == {"ram.hex": "3\n0\n"}
    with pytest.raises(ValueError, match="two memories named ram"):
        move_contents(2 * memory.format(3), "x")
