"""The register writes of a frame on AXI: what the driver would write."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.register_map import register_map
from splatline.host.device.driver import Driver

__all__ = ["ADDRESS_BITS", "DATA_BITS", "register_writes"]

ADDRESS_BITS, DATA_BITS = 16, 32
"""Bits of a register's byte address, which lies above its data, and of the data."""


class _Recorder:
    """A device that remembers what is written, and reads as after a reset."""

    def __init__(self, config: EngineConfig) -> None:
        registers = register_map(config)
        self.writes: list[int] = []
        self._resets = {
            register.offset: sum(field.reset << field.place.lsb for field in register.fields)
            for register in registers.registers
        }

    def read32(self, offset: int) -> int:
        """Return a register's value after reset."""
        return self._resets.get(offset, 0)

    def write32(self, offset: int, value: int) -> None:
        """Remember a write."""
        self.writes.append(offset << DATA_BITS | value)

    def write_words(self, offset: int, words: npt.NDArray[np.uint32]) -> None:
        """Remember writes of registers that follow each other."""
        for place, word in enumerate(words.tolist()):
            self.write32(offset + 4 * place, word)


def register_writes(frames: list[Frame]) -> list[npt.NDArray[np.uint64]]:
    """Return the writes before each frame, of which all but the first are drawn over a raster.

    Returns
    -------
    list of numpy.ndarray
        Of each frame shape (n, 1), uint64: data in bits 0..31, the byte address above. A later
        frame has the materials that change.
    """
    recorder = _Recorder(frames[0].config)
    driver = Driver(recorder)
    recorder.writes.clear()  # that makes the bus answer without errors
    writes = []
    for number, frame in enumerate(frames):
        driver.write_tables(frame.tables, frame.width, frame.height)
        driver.set("START", LOAD=int(number > 0))
        writes.append(np.array(recorder.writes, np.uint64).reshape(-1, 1))
        recorder.writes.clear()
    return writes
