"""An engine on a PCIe board, behind AMD's XDMA core and its Linux driver.

The core's AXI4-Lite master reaches the registers. Its streams to and from the card are the
engine's. Its driver offers them as files: ``/dev/xdma0_user`` is mapped into memory,
``/dev/xdma0_h2c_N`` is written and ``/dev/xdma0_c2h_N`` is read
(https://github.com/Xilinx/dma_ip_drivers, XDMA). **No board has run this yet**: it is tested on
files and pipes that behave as the driver's documentation says.
"""

from __future__ import annotations

import contextlib
import errno
import mmap
import os
import select
import threading
import time
from pathlib import Path
from types import TracebackType

import numpy as np
import numpy.typing as npt

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.errors import InputError

from .device import DeviceLostError, DeviceTimeoutError
from .driver import read_config

__all__ = ["XdmaDevice"]

CHUNK = 1 << 22
"""Most bytes of one read."""

LONGEST_WAIT = 0.1
"""Seconds after which a wait looks whether the packets can be written."""

PATIENCE = (errno.ETIMEDOUT, errno.EAGAIN, errno.EINTR, errno.ERESTART)
"""Errors of a read that say that nothing has come yet."""


class XdmaDevice:
    """A board with an engine; use it in a ``with``, or call :meth:`close`.

    The core's streams are as wide as the engine's, or a width converter lies between. One
    ``write`` sends a packet. The files are opened with ``O_TRUNC``, which tells some versions of
    the driver to set TLAST, and to end a read at TLAST.

    Parameters
    ----------
    card
        Prefix of the files' names.
    registers, codewords, initial, raster
        Suffixes of the files' names: the registers, two streams to the card and one from it.
        ``initial`` may be None if no frame starts from a raster.
    timeout
        Seconds after which :meth:`receive` gives up.

    Raises
    ------
    InputError
        If a file cannot be opened, or there is no engine.
    """

    def __init__(
        self,
        card: str = "/dev/xdma0",
        *,
        registers: str = "_user",
        codewords: str = "_h2c_0",
        initial: str | None = "_h2c_1",
        raster: str = "_c2h_0",
        timeout: float = 10.0,
    ) -> None:
        self.timeout = timeout
        self._rest = b""
        self._senders: list[threading.Thread] = []
        self._trouble: list[OSError] = []
        with contextlib.ExitStack() as stack:
            memory = _open(stack, card + registers, os.O_RDWR | os.O_SYNC)
            try:
                mapped = stack.enter_context(mmap.mmap(memory, BYTES))
            except (OSError, ValueError) as error:
                raise InputError(f"{card}{registers}: cannot be mapped ({error})") from error
            self._registers = np.frombuffer(mapped, np.uint32)
            stack.callback(self._release)
            self._raster = _open(stack, card + raster, os.O_RDONLY | os.O_TRUNC)
            self._codewords = _open(stack, card + codewords, os.O_WRONLY | os.O_TRUNC)
            self._initial = (
                None if initial is None else _open(stack, card + initial, os.O_WRONLY | os.O_TRUNC)
            )
            config = read_config(self)
            self._beat, self._end = raster_stream_bytes(config), config.raster_end.lsb
            words = config.max_width // config.raster_pixels
            self._most = self._beat * (config.max_height * words + 1)
            self._stack = stack.pop_all()

    def read32(self, offset: int) -> int:
        """Read a register."""
        return int(self._registers[offset // 4])

    def write32(self, offset: int, value: int) -> None:
        """Write a register: one access of 32 bits."""
        self._registers[offset // 4] = value

    def write_words(self, offset: int, words: npt.NDArray[np.uint32]) -> None:
        """Write registers that follow each other."""
        # A register bus takes accesses of 32 bits, and a copied array has wider ones.
        for place, word in enumerate(words.tolist(), offset // 4):
            self._registers[place] = word

    def send(
        self, codewords: npt.NDArray[np.uint64], initial: npt.NDArray[np.uint64] | None = None
    ) -> None:
        """Start to write a packet of code words, and one of an initial raster.

        A write returns once the engine has taken the data, and the engine may wait until beats of
        the raster are read. So a thread writes each stream.
        """
        if initial is not None:
            if self._initial is None:
                raise InputError("this device was opened without a stream for an initial raster")
            self._start(self._initial, initial)
        self._start(self._codewords, codewords)

    def receive(self) -> npt.NDArray[np.uint64]:
        """Read beats up to the end beat.

        Raises
        ------
        DeviceTimeoutError
            If the end beat does not come in time.
        DeviceLostError
            If a packet cannot be written or is not taken in time; if the raster cannot be read, or
            has more beats than any picture.
        """
        deadline = time.monotonic() + self.timeout
        while (size := self._packet(self._rest)) is None:
            self._check_senders()
            if len(self._rest) > self._most:
                raise DeviceLostError("the raster has more beats than any picture, and no end beat")
            left = deadline - time.monotonic()
            if left <= 0:
                raise DeviceTimeoutError(f"no end beat after {self.timeout} s")
            if select.select([self._raster], [], [], min(left, LONGEST_WAIT))[0]:
                self._rest += self._read()
        data, self._rest = self._rest[:size], self._rest[size:]
        for sender in self._senders:
            sender.join(max(LONGEST_WAIT, deadline - time.monotonic()))
            if sender.is_alive():
                raise DeviceLostError("the frame has ended, but its packets were not taken")
        self._senders.clear()
        self._check_senders()
        return np.frombuffer(data, "<u8").reshape(-1, self._beat // 8)

    def _read(self) -> bytes:
        """Return a piece of the raster, which is there."""
        try:
            piece = os.read(self._raster, CHUNK)
        except OSError as error:
            if error.errno in PATIENCE:  # the driver has a limit of its own
                raise DeviceTimeoutError(f"the raster could not be read: {error}") from error
            raise DeviceLostError(f"the raster cannot be read: {error}") from error
        if not piece:
            raise DeviceLostError("the raster's stream has ended, before an end beat")
        return piece

    def _check_senders(self) -> None:
        """Raise if a packet could not be written."""
        if self._trouble:
            error = self._trouble.pop()
            raise DeviceLostError(f"a packet cannot be written: {error}") from error

    def close(self) -> None:
        """Close the files."""
        self._stack.close()

    def __enter__(self) -> XdmaDevice:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _packet(self, data: bytes) -> int | None:
        """Return the bytes up to the first end beat, or None if it has not come."""
        whole = len(data) // self._beat * self._beat
        limbs = np.frombuffer(data[:whole], "<u8").reshape(-1, self._beat // 8)
        limb, shift = divmod(self._end, 64)
        ends = np.flatnonzero(limbs[:, limb] >> np.uint64(shift) & np.uint64(1))
        return int(ends[0] + 1) * self._beat if len(ends) else None

    def _start(self, file: int, words: npt.NDArray[np.uint64]) -> None:
        """Write words in a thread."""
        data = words.astype("<u8").tobytes()

        def write() -> None:
            rest = memoryview(data)
            try:
                while rest:
                    rest = rest[os.write(file, rest) :]
            except OSError as error:
                self._trouble.append(error)

        self._senders.append(threading.Thread(target=write, daemon=True))
        self._senders[-1].start()

    def _release(self) -> None:
        """Release the mapping, which cannot be closed while an array uses it."""
        del self._registers


BYTES = 1 << 14
"""Bytes of the registers and the tables."""


def _open(stack: contextlib.ExitStack, path: str, flags: int) -> int:
    """Open a file that the stack will close."""
    try:
        file = os.open(Path(path), flags)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; is the driver loaded?") from error
    stack.callback(os.close, file)
    return file
