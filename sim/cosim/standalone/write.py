"""The files of the standalone bench, and the numbers in them."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.contract.atomic_write import atomic_write
from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster_beats import to_beats
from splatline.sim import golden
from splatline.sim.cosim.player.hex_words import hex_lines
from splatline.sim.cosim.player.jobs import table_writes

from .frames import bench_frames
from .register_writes import ADDRESS_BITS, DATA_BITS, register_writes

__all__ = ["FILES", "write_bench"]

FILES = (
    "bench.v",
    "bench_source.v",
    "bench_sizes.vh",
    "codewords.hex",
    "initial.hex",
    "raster.hex",
    "README",
)
"""Names of the files; ``tables.hex`` or, for the AXI top, ``registers.hex`` comes with them."""

README = """\
A self-checking test bench for {top} of preset {preset}, in plain Verilog.

Icarus Verilog, in this folder:

    iverilog -g2005 -o bench.vvp bench.v bench_source.v {verilog} && vvp bench.vvp

Verilator, 5.036 or later:

    verilator --binary -Wno-fatal --output-split 0 -CFLAGS "-fcoroutines" --top-module bench \\
        bench.v bench_source.v {verilog} && obj_dir/Vbench

Either prints PASS and exits with 0, or prints FAIL with the first unlike beat and exits with 1.

bench.v         the bench: it offers the streams, and compares what comes out
bench_source.v  a stream from a file
bench_sizes.vh  the top's name, widths of its streams, lengths of the files below
{writes}
codewords.hex   code words of both frames
initial.hex     the raster that the second frame starts from
raster.hex      what must come out: the beats of both frames, by the golden renderer
"""

WRITES = {
    "engine": "tables.hex      table writes of both frames",
    "axi": "registers.hex   writes of registers: 16 bits of address, 32 of data",
}
"""The README's line on the writes before a frame, by top."""

_Words = npt.NDArray[np.uint64]


@dataclass(frozen=True)
class _Played:
    """Files for both benches: of two frames the code words, an initial raster, the pictures."""

    frames: list[Frame]
    codewords: list[_Words]
    initial: _Words
    pictures: list[_Words]


def write_bench(
    config: EngineConfig, name: str, verilog: str, folder: Path, top: str = "engine"
) -> None:
    """Write the bench of an engine into a folder that is there.

    Two frames are drawn: the first from background, the second over the picture of the first.

    Parameters
    ----------
    config
        The engine's configuration.
    name
        Name of its top module.
    verilog
        Path of its Verilog, relative to ``folder``.
    folder
        Where the files go.
    top
        ``engine`` or ``axi``.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    frames = bench_frames(config)
    start = golden.render(frames[0])
    beats = to_beats(start)
    words = [frame.codewords.reshape(len(frame.codewords), -1) for frame in frames]
    pictures = [beats, to_beats(golden.render(frames[1], start))]
    played = _Played(frames, words, beats, pictures)
    contents, sizes = {"engine": _engine_contents, "axi": _axi_contents}[top](played, config)
    sizes |= {
        "CODEWORDS_OF_FIRST": len(words[0]),
        "CODEWORDS": sum(map(len, words)),
        "INITIALS": len(beats),
        "BEATS": sum(map(len, pictures)),
    }
    for file, (numbers, bits) in contents.items():
        atomic_write(folder / f"{file}.hex", hex_lines(numbers, bits))
    defines = {"ENGINE": name, **sizes}
    texts = {
        "bench.v": _read("bench.v" if top == "engine" else "bench_axi.v"),
        "bench_source.v": _read("bench_source.v"),
        "bench_sizes.vh": "".join(f"`define {key} {value}\n" for key, value in defines.items()),
        "README": README.format(top=name, verilog=verilog, preset=config.name, writes=WRITES[top]),
    }
    for file, text in texts.items():
        atomic_write(folder / file, text.encode())


def _read(name: str) -> str:
    """Return a file of this package."""
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _engine_contents(
    played: _Played, config: EngineConfig
) -> tuple[dict[str, tuple[_Words, int]], dict[str, int]]:
    """Return numbers and bits of each file of the engine's bench, and its sizes."""
    tables = [
        table_writes(frame.tables, frame.width, frame.height, number > 0, config)
        for number, frame in enumerate(played.frames)
    ]
    table, word, beat = config.table_address.end, config.codeword_bits, config.raster_end.end
    return {
        "tables": (np.concatenate(tables), table),
        "codewords": (np.concatenate(played.codewords), word),
        "initial": (played.initial, beat),
        "raster": (np.concatenate(played.pictures), beat),
    }, {
        "TABLE_BITS": table,
        "CODEWORD_BITS": word,
        "BEAT_BITS": beat,
        "TABLES_OF_FRAME": len(tables[0]),
    }


def _axi_contents(
    played: _Played, config: EngineConfig
) -> tuple[dict[str, tuple[_Words, int]], dict[str, int]]:
    """Return numbers and bits of each file of the AXI top's bench, and its sizes."""
    writes = register_writes(played.frames)
    word, beat = 8 * codeword_stream_bytes(config), 8 * raster_stream_bytes(config)
    return {
        "registers": (np.concatenate(writes), ADDRESS_BITS + DATA_BITS),
        "codewords": (np.concatenate([_packet(each, word) for each in played.codewords]), word + 1),
        "initial": (_packet(played.initial, beat), beat + 1),
        "raster": (np.concatenate([_packet(each, beat) for each in played.pictures]), beat + 1),
    }, {
        "CODEWORD_BITS": word,
        "BEAT_BITS": beat,
        "END_BIT": config.raster_end.lsb,
        "WRITES_OF_FIRST": len(writes[0]),
        "WRITES": sum(map(len, writes)),
        "BEATS_OF_FIRST": len(played.pictures[0]),
    }


def _packet(words: _Words, bits: int) -> _Words:
    """Return the words of a packet as TDATA of ``bits`` bits, with TLAST above it."""
    wide = np.zeros((len(words), bits // 64 + 1), np.uint64)
    wide[:, : words.shape[1]] = words
    wide[-1, -1] |= np.uint64(1)
    return wide
