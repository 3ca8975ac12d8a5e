"""The files of the standalone bench, and the numbers in them."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.host.files.atomic_write import atomic_write
from splatline.sim import golden
from splatline.sim.cosim.player.hex_words import write_hex
from splatline.sim.cosim.player.jobs import table_writes

from .frames import bench_frames

__all__ = ["FILES", "write_bench"]

FILES = (
    "bench.v",
    "bench_sizes.vh",
    "tables.hex",
    "codewords.hex",
    "initial.hex",
    "raster.hex",
    "README",
)
"""Names of the files."""

README = """\
A self-checking test bench for the engine {top} of preset {preset}, in plain Verilog.

Icarus Verilog, in this folder:

    iverilog -g2005 -o bench.vvp bench.v {verilog} && vvp bench.vvp

Verilator, 5.036 or later:

    verilator --binary -Wno-fatal --output-split 0 -CFLAGS "-fcoroutines" --top-module bench \\
        bench.v {verilog} && obj_dir/Vbench

Either prints PASS and exits with 0, or prints FAIL with the first unlike beat and exits with 1.

bench.v         the bench: it offers the streams, and compares what comes out
bench_sizes.vh  the engine's name, widths of its streams, lengths of the files below
tables.hex      table writes of both frames: {table_bits} bits each
codewords.hex   code words of both frames: {codeword_bits} bits each
initial.hex     the raster that the second frame starts from: beats of {beat_bits} bits
raster.hex      what must come out: the beats of both frames, by the golden renderer
"""


def write_bench(config: EngineConfig, top: str, verilog: str, folder: Path) -> None:
    """Write the bench of an engine into a folder that is there.

    Two frames are drawn: the first from background, the second over the picture of the first.

    Parameters
    ----------
    config
        The engine's configuration.
    top
        Name of its top module.
    verilog
        Path of its Verilog, relative to ``folder``.
    folder
        Where the files go.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    first, second = bench_frames(config)
    start = golden.render(first)
    tables = [table_writes(first.tables, first.width, first.height, False, config),
              table_writes(second.tables, second.width, second.height, True, config)]  # fmt: skip
    initial = to_beats(start)
    pictures = [initial, to_beats(golden.render(second, start))]
    words = [frame.codewords.reshape(len(frame.codewords), -1) for frame in (first, second)]
    bits = {
        "table": config.table_address.end,
        "codeword": config.codeword_bits,
        "beat": config.raster_end.end,
    }
    write_hex(folder / "tables.hex", np.concatenate(tables), bits["table"])
    write_hex(folder / "codewords.hex", np.concatenate(words), bits["codeword"])
    write_hex(folder / "initial.hex", initial, bits["beat"])
    write_hex(folder / "raster.hex", np.concatenate(pictures), bits["beat"])
    sizes = {
        "ENGINE": top,
        **{f"{name.upper()}_BITS": number for name, number in bits.items()},
        "TABLES_OF_FRAME": len(tables[0]),
        "CODEWORDS_OF_FIRST": len(words[0]),
        "CODEWORDS": sum(map(len, words)),
        "INITIALS": len(initial),
        "BEATS": sum(map(len, pictures)),
    }
    lines = (f"`define {name} {value}\n" for name, value in sizes.items())
    bench = resources.files(__package__).joinpath("bench.v").read_text(encoding="utf-8")
    texts = {
        "bench.v": bench,
        "bench_sizes.vh": "".join(lines),
        "README": README.format(
            top=top, verilog=verilog, preset=config.name,
            **{f"{name}_bits": number for name, number in bits.items()},
        ),
    }  # fmt: skip
    for name, text in texts.items():
        atomic_write(folder / name, text.encode())
