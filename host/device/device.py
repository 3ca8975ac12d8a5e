"""The interface of a device: registers, and streams in and out."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

__all__ = ["BusError", "Device", "DeviceLostError", "DeviceTimeoutError", "Registers"]


class BusError(OSError):
    """The register bus answered with an error."""


class DeviceTimeoutError(TimeoutError):
    """A packet of the raster did not end in time."""


class DeviceLostError(OSError):
    """The device is gone, or what its streams hold is unknown: it must be opened again."""


class Registers(Protocol):
    """The registers of an engine, on whatever bus they are."""

    def read32(self, offset: int) -> int:
        """Return the register at a byte offset.

        Raises
        ------
        BusError
            If the bus answers with an error and passes it on.
        """

    def write32(self, offset: int, value: int) -> None:
        """Write the register at a byte offset; the write is complete on return.

        Raises
        ------
        BusError
            If the bus answers with an error and passes it on.
        """

    def write_words(self, offset: int, words: npt.NDArray[np.uint32]) -> None:
        """Write registers that follow each other, each in an access of 32 bits.

        Parameters
        ----------
        offset
            Byte offset of the first.
        words
            Shape (n,), uint32.

        Raises
        ------
        BusError
            If the bus answers with an error and passes it on.
        """


class Device(Registers, Protocol):
    """An engine on its buses: a board (:mod:`splatline.host.device.xdma`) or a simulation of one.

    A simulation is :class:`splatline.sim.cosim.axi.axi_device.SimulatedDevice`.
    """

    def send(
        self, codewords: npt.NDArray[np.uint64], initial: npt.NDArray[np.uint64] | None = None
    ) -> None:
        """Start to send a packet of code words; the device may take it later.

        Parameters
        ----------
        codewords
            Shape (n,), uint64, or (n, 2) of plane words, the low half first.
        initial
            An initial raster, as :meth:`receive` returns one.
        """

    def receive(self) -> npt.NDArray[np.uint64]:
        """Wait for a packet of the raster, its end beat included.

        Returns
        -------
        numpy.ndarray
            Shape (n, bytes of a beat / 8), uint64, the lowest limb first.

        Raises
        ------
        DeviceTimeoutError
            If it does not end in time.
        DeviceLostError
            If a packet could not be sent, or the raster cannot be read or makes no sense.
        """
