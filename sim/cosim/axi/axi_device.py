"""A simulated device: the Verilog of the AXI top, in a simulator process of its own.

It has the interface of a board (:class:`splatline.host.device.device.Device`), so the driver works
with both. Each command is executed by :mod:`splatline.sim.cosim.axi.axi_bench` inside the
simulator, which sends back the result.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import DEFAULT
from splatline.host.device.device import BusError, DeviceTimeoutError
from splatline.sim.cosim import simulator
from splatline.sim.cosim.kept_verilog import kept, parts_of_build
from splatline.sim.cosim.served import ServedSimulator
from splatline.sim.cosim.simulator import Build, SimulationError

__all__ = ["SimulatedDevice", "build_axi"]

VISIBLE = [
    ("splatline__engine", name)
    for name in (
        *("codewords__valid", "codewords__ready"),
        *("raster__valid", "raster__ready", "raster__payload"),
    )
]
"""Internal signals that the bench reads: the engine's streams of code words and raster beats."""


def build_axi(
    config: EngineConfig = DEFAULT,
    simulator_name: str = "verilator",
    *,
    edit: Callable[[str], str] = lambda text: text,
    options: Sequence[str] = (),
    progress: Callable[[float], None] | None = None,
) -> Build:
    """Build the simulator of an AXI top, or return its cached build.

    ``edit`` changes the Verilog, such as to plant a fault. ``options`` are the simulator's.
    ``progress`` is called now and then with the share of the build that is done.
    """
    writing, building = parts_of_build(progress)

    def write() -> str:
        from splatline.flow.axi_verilog import generate_axi

        return generate_axi(config, progress=writing)[0]

    return simulator.build(
        {"splatline.v": edit(kept("axi", config, write))},
        "splatline",
        simulator=simulator_name,
        visible=VISIBLE,
        options=options,
        progress=building,
    )


AT_ONCE = 2048
"""Cycles of one command that waits for a packet."""


class SimulatedDevice(ServedSimulator):
    """A simulator of an AXI top; use it in a ``with``, or call :meth:`close`.

    Parameters
    ----------
    config
        The engine's configuration.
    stall
        Share of the cycles, 0..1 without 1, in which each channel of each bus stalls.
    seed
        Seed of the random stalls.
    limit
        Cycles after which :meth:`receive` gives up.
    built
        Build to use instead of the configuration's own, such as one with a planted fault.
    reset_edges
        Clock edges of the reset before the first command.
    plusargs
        Arguments for the Verilog, such as ``+fault=1``.
    waits
        Called now and then with the cycles that :meth:`receive` has waited.

    Raises
    ------
    InputError
        If the simulator or cocotbext-axi is not installed.
    SimulationError
        If it cannot be built or started; raised by every method if the simulator stops.
    """

    def __init__(
        self,
        config: EngineConfig = DEFAULT,
        *,
        stall: float = 0.0,
        seed: int = 1,
        limit: int = 1_000_000,
        built: Build | None = None,
        reset_edges: int = 4,
        plusargs: Sequence[str] = (),
        waits: Callable[[int], None] = lambda cycles: None,
    ) -> None:
        if not 0.0 <= stall < 1.0:
            raise ValueError(f"stall must be in 0..1 without 1, not {stall}")
        if importlib.util.find_spec("cocotbext") is None:
            raise InputError(
                f"an engine on AXI is simulated with cocotbext-axi: {install_hint('cosim')}"
            )
        self.config = config
        self.limit = limit
        self.waits = waits
        built = build_axi(config) if built is None else built
        super().__init__(
            built,
            f"{__package__}.axi_bench",
            plusargs=plusargs,
            environment={"SPLATLINE_RESET_EDGES": str(reset_edges)},
        )
        if stall:
            self.command("stall", stall, seed)

    def read32(self, offset: int) -> int:
        """Read a register."""
        value, response = self.command("read", offset)
        if response:
            raise BusError(f"the read at {offset:#x} was refused ({_RESPONSES[response]})")
        return int(value)

    def write32(self, offset: int, value: int) -> None:
        """Write a register."""
        self.write_words(offset, np.array([value], np.uint32))

    def write_words(self, offset: int, words: npt.NDArray[np.uint32]) -> None:
        """Write registers that follow each other; the bus has several writes under way."""
        response = self.command("write", offset, words.astype("<u4").tobytes())
        if response:
            raise BusError(f"the write at {offset:#x} was refused ({_RESPONSES[response]})")

    def send(
        self, codewords: npt.NDArray[np.uint64], initial: npt.NDArray[np.uint64] | None = None
    ) -> None:
        """Offer a packet of code words, and one of an initial raster."""
        if initial is not None:
            self.command("send", "initial", initial.astype("<u8").tobytes(), None)
        self.command("send", "codewords", codewords.astype("<u8").tobytes(), None)

    def receive(self) -> npt.NDArray[np.uint64]:
        """Wait for a packet of the raster."""
        waited, data = 0, None
        while data is None and waited < self.limit:
            data = self.command("receive", min(AT_ONCE, self.limit - waited))
            waited += AT_ONCE
            self.waits(waited)
        broken = self.command("rules")
        if broken:
            raise SimulationError(f"the engine broke a rule of its buses: {broken[0]}")
        if data is None:
            raise DeviceTimeoutError(f"no end beat after {self.limit} cycles")
        return np.frombuffer(data, "<u8").reshape(-1, raster_stream_bytes(self.config) // 8)


_RESPONSES = {2: "SLVERR", 3: "DECERR"}
