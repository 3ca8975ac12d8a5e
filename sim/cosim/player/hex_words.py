"""Text files of hexadecimal numbers, one a line, as Verilog reads and writes them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.sim.cosim.simulator import SimulationError

__all__ = ["hex_lines", "read_hex", "write_hex"]


def hex_lines(words: npt.NDArray[np.uint64], bits: int) -> bytes:
    """Return numbers of ``bits`` bits; ``words`` has shape (n, limbs), lowest limb first."""
    digits = math.ceil(bits / 4)
    data = np.ascontiguousarray(words[:, ::-1]).astype(">u8").tobytes().hex()
    row = 16 * words.shape[1]
    text = np.frombuffer(data.encode(), np.uint8).reshape(-1, row)[:, row - digits :]
    lines = np.full((len(text), digits + 1), ord("\n"), np.uint8)
    lines[:, :-1] = text
    return lines.tobytes()


def write_hex(path: Path, words: npt.NDArray[np.uint64], bits: int) -> None:
    """Write :func:`hex_lines` to a file."""
    path.write_bytes(hex_lines(words, bits))


def read_hex(path: Path, bits: int) -> npt.NDArray[np.uint64]:
    """Read numbers of ``bits`` bits that a simulator wrote with ``%h``: shape (n, limbs)."""
    digits = math.ceil(bits / 4)
    limbs = math.ceil(bits / 64)
    text = np.frombuffer(path.read_bytes(), np.uint8)
    if len(text) % (digits + 1):
        raise SimulationError(f"{path.name}: not whole lines of {digits} digits")
    lines = np.full((len(text) // (digits + 1), 16 * limbs), ord("0"), np.uint8)
    lines[:, 16 * limbs - digits :] = text.reshape(-1, digits + 1)[:, :-1]
    try:
        data = bytes.fromhex(lines.tobytes().decode())
    except ValueError:
        raise SimulationError(f"{path.name}: the Verilog put out undefined bits (x)") from None
    return np.frombuffer(data, ">u8").reshape(-1, limbs)[:, ::-1].astype(np.uint64)
