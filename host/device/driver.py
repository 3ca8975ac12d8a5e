"""The driver of an engine on its buses: registers by name, tables, frames as beats.

:class:`Engine` draws pictures with it. It does not know whether the
device is a board or a simulation.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Tables, check_codewords, check_tables
from splatline.contract.presets import PAPER, PLANE
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.contract.register_map import CHOICES, COUNTERS, IDENTITY, register_map, version_of
from splatline.contract.register_types import RegisterMap
from splatline.contract.variants import CONFIGS

from .device import Device, DeviceLostError, DeviceTimeoutError, Registers

__all__ = ["Driver", "Engine", "EngineError", "read_config"]


class EngineError(RuntimeError):
    """The engine reported an error in a frame; it is ready for the next frame.

    Parameters
    ----------
    names
        Bits of the register ERROR that were set.
    beats
        The picture that it drew nevertheless; None if it is unknown.
    """

    def __init__(
        self, message: str, names: Iterable[str] = (), beats: npt.NDArray[np.uint64] | None = None
    ) -> None:
        super().__init__(message)
        self.names = tuple(names)
        self.beats = beats


def read_config(device: Registers) -> EngineConfig:
    """Return the configuration of the engine in a device.

    Raises
    ------
    InputError
        If there is no engine, or one of another version of the registers.
    """
    # These registers are the same for every configuration, so PAPER's map has their offsets.
    registers = register_map(PAPER)
    identity = device.read32(registers["ID"].offset)
    if identity != IDENTITY:
        raise InputError(
            f"the device is no Splatline engine: its ID is {identity:#010x}, not {IDENTITY:#010x}"
        )
    major = registers["VERSION"]["MAJOR"].place
    found = device.read32(registers["VERSION"].offset) >> major.lsb & major.mask
    plane = registers["CONFIG_1"]["PLANE"].mask & device.read32(registers["CONFIG_1"].offset)
    wanted, _ = version_of(PLANE if plane else PAPER)
    if found != wanted:
        raise InputError(f"the engine has version {found} of the registers, not {wanted}")
    names = {field.name for field in dataclasses.fields(EngineConfig)}
    values: dict[str, Any] = {}
    for register in (registers["CONFIG_0"], registers["CONFIG_1"]):
        word = device.read32(register.offset)
        for field in register.fields:
            if field.name.lower() in names:
                values[field.name.lower()] = word >> field.place.lsb & field.place.mask
    try:
        # The register holds a choice's number.
        for name, choices in CHOICES.items():
            values[name] = choices[values[name]]
        values["plane"] = bool(values["plane"])
        if not values["plane"]:
            del values["slope_bits"]  # its register is 0
        config = PAPER.replace(**values)
    except (ValueError, IndexError) as error:
        raise InputError(f"the engine's configuration makes no sense: {error}") from error
    for known in CONFIGS.values():
        if known == config.replace(name=known.name):
            return known
    return config


class Driver:
    """An engine's registers and tables, whatever its streams are.

    Parameters
    ----------
    device
        Its registers. The engine's configuration is read from them, and CONTROL.QUIET is set: on a
        board, a bus error would be a processor fault.

    Raises
    ------
    InputError
        If there is no engine, or the driver does not know it.
    """

    def __init__(self, device: Registers) -> None:
        self.device = device
        self.config = read_config(device)
        self.registers: RegisterMap = register_map(self.config)
        self._entries: npt.NDArray[np.uint32] | None = None
        self.set("CONTROL", QUIET=1)

    def get(self, register: str, field: str = "VALUE") -> int:
        """Return a field of a register."""
        place = self.registers[register][field].place
        return self.device.read32(self.registers[register].offset) >> place.lsb & place.mask

    def set(self, register: str, **fields: int) -> None:
        """Write a whole register; fields that are not named become 0."""
        word = 0
        for name, value in fields.items():
            place = self.registers[register][name].place
            if not 0 <= value <= place.mask:
                raise ValueError(f"{register}.{name} has {place.width} bits: {value} does not fit")
            word |= value << place.lsb
        self.device.write32(self.registers[register].offset, word)

    def write_tables(self, tables: Tables, width: int, height: int) -> None:
        """Write the tables and the image size of later frames, until the next call.

        Parameters
        ----------
        tables
            Materials and I0. Only materials that have changed are written.
        width, height
            Size of the image in pixels.

        Raises
        ------
        InputError
            If the image is larger than the engine's, or the tables are for another engine.
        EngineError
            If the engine refused a write.
        """
        config = self.config
        if not (0 < width <= config.max_width and 0 < height <= config.max_height):
            raise InputError(
                f"an image of {width}x{height} pixels does not fit the engine's"
                f" {config.max_width}x{config.max_height}"
            )
        check_tables(tables, config)
        self.clear("ERROR")
        entries, before = self._pack(tables), self._entries
        changed = (
            np.arange(len(entries))
            if before is None
            else np.flatnonzero((entries != before).any(axis=1))
        )
        self._entries = None
        self._write_materials(changed, entries[changed])
        for channel, ambient in zip(("RED", "GREEN", "BLUE"), tables.ambient, strict=True):
            self.set(f"AMBIENT_{channel}", VALUE=int(ambient))
        self.set("LAST_COLUMN", VALUE=width - 1)
        self.set("LAST_LINE", VALUE=height - 1)
        self._raise_errors("the tables were not taken")
        self._entries = entries

    def _write_materials(
        self, numbers: npt.NDArray[np.intp], entries: npt.NDArray[np.uint32]
    ) -> None:
        """Write entries of the material table; those without a gap between them at once."""
        window = self.registers.materials
        starts = window.offset + window.stride * numbers
        ends = np.flatnonzero(np.diff(starts) != 4 * window.words) + 1
        for run, words in zip(np.split(starts, ends), np.split(entries, ends), strict=True):
            if len(run):
                self.device.write_words(int(run[0]), words.ravel())

    def counters(self) -> dict[str, int]:
        """Return the counters by name in small letters; each wraps at 2**32."""
        return {name.lower(): self.get(name) for name in COUNTERS}

    def clear_counters(self) -> None:
        """Set the counters to 0."""
        self.set("CONTROL", QUIET=1, CLEAR=1)

    def errors(self) -> list[str]:
        """Return the names of the bits of ERROR that are set.

        Raises
        ------
        DeviceLostError
            If bits are set that the register does not have.
        """
        word = self._read("ERROR")
        return [field.name for field in self.registers["ERROR"].fields if word & field.mask]

    def clear(self, name: str) -> None:
        """Clear the set bits of a register that a written 1 clears.

        Raises
        ------
        DeviceLostError
            If bits are set that the register does not have.
        """
        register = self.registers[name]
        word = self._read(name) & register.writable
        if word:
            self.device.write32(register.offset, word)

    def _read(self, name: str) -> int:
        """Return a register; raise if it has bits that it lacks, as of a card that is gone."""
        register = self.registers[name]
        word = self.device.read32(register.offset)
        if word & ~sum(field.mask for field in register.fields):
            raise DeviceLostError(f"the device is gone: its register {name} reads as {word:#010x}")
        return word

    def _raise_errors(self, what: str, beats: npt.NDArray[np.uint64] | None = None) -> None:
        """Raise if a bit of ERROR is set, and clear it."""
        names = self.errors()
        if names:
            self.clear("ERROR")
            register = self.registers["ERROR"]
            reasons = "; ".join(f"{name}: {register[name].meaning}" for name in names)
            raise EngineError(f"{what}: {reasons}", names, beats)

    def _pack(self, tables: Tables) -> npt.NDArray[np.uint32]:
        """Return the words of the material table's entries: shape (entries, words), uint32."""
        window = self.registers.materials
        words = np.zeros((window.entries, window.words + 1), np.uint64)
        for kind, table in enumerate((tables.diffuse, tables.specular)):
            for channel in range(3):
                place = self.config.coefficient(kind, channel)
                word, shift = divmod(place.lsb, 32)
                bits = table[:, channel].astype(np.uint64) << np.uint64(shift)
                words[: len(table), word] |= bits & np.uint64(0xFFFF_FFFF)
                words[: len(table), word + 1] |= bits >> np.uint64(32)
        return words[:, :-1].astype(np.uint32)


class Engine(Driver):
    """Draws frames of code words with the engine in a device.

    >>> with SimulatedDevice() as device:  # or XdmaDevice(): a board
    ...     engine = Engine(device)
    ...     engine.write_tables(frame.tables, frame.width, frame.height)
    ...     raster = engine.draw(frame.codewords)

    Parameters and errors are those of :class:`Driver`; the device has streams too.
    """

    device: Device

    def __init__(self, device: Device) -> None:
        super().__init__(device)
        self._lost = ""

    def draw(self, codewords: npt.NDArray[np.uint64], initial: Raster | None = None) -> Raster:
        """Draw a frame with the tables and the size that were written.

        Parameters
        ----------
        codewords
            Shape (n,), uint64, or (n, 2) for an engine with planes; the last is the end word.
        initial
            The picture to start from; background if not given.

        Raises
        ------
        EngineError
            If the engine found an error in the frame, or its beats are no picture of that size; the
            next frame is not affected.
        DeviceLostError
            As :meth:`draw_beats`.
        """
        beats = self.draw_beats(codewords, None if initial is None else to_beats(initial))
        width, height = self.get("LAST_COLUMN") + 1, self.get("LAST_LINE") + 1
        try:
            return from_beats(beats, width, height, self.config)
        except ValueError as error:
            raise EngineError(f"the engine sent no picture: {error}", (), beats) from error

    def draw_beats(
        self,
        codewords: npt.NDArray[np.uint64],
        initial: npt.NDArray[np.uint64] | None = None,
    ) -> npt.NDArray[np.uint64]:
        """Draw a frame.

        Parameters
        ----------
        codewords
            Shape (n,), uint64, or (n, 2) for an engine with planes; the last is the end word.
        initial
            Beats of the raster to start from, an end beat last: shape (n, limbs), uint64.

        Returns
        -------
        numpy.ndarray
            The beats of the picture, an end beat last: shape (n, limbs of 64 bits), uint64.

        Raises
        ------
        InputError
            If there are no code words, or they have another shape than the engine's.
        EngineError
            If the engine found an error in the frame, or did not end it in time; then the frame was
            aborted. In both cases the engine is ready for the next frame.
        DeviceLostError
            If an aborted frame does not end either, or the device fails otherwise. So does every
            later call: what the streams still hold belongs to a frame that nobody waits for. Open
            the device again.
        """
        if self._lost:
            raise DeviceLostError(f"the device was lost before: {self._lost}; open it again")
        if not len(codewords):
            raise InputError("a frame has at least its end word")
        check_codewords(codewords, self.config)
        self.clear("ERROR")
        self.clear("IRQ_STATUS")
        self.set("START", LOAD=int(initial is not None))
        self._raise_errors("no frame can begin")
        beats = None if initial is None else self.widen(initial)
        drawn = self._exchange(np.ascontiguousarray(codewords, np.uint64), beats)
        drawn = drawn[:, : -(-self.config.raster_end.end // 64)]
        self._raise_errors("the frame was drawn, but", drawn)
        return drawn

    def _exchange(
        self, codewords: npt.NDArray[np.uint64], initial: npt.NDArray[np.uint64] | None
    ) -> npt.NDArray[np.uint64]:
        """Send the packets of a frame, and return the raster's.

        Whatever comes between, an interrupt from the keyboard as well, the device is lost: its
        streams would be a frame apart.
        """
        try:
            self.device.send(codewords, initial)
            try:
                return self.device.receive()
            except DeviceTimeoutError as error:
                try:
                    self.abort()
                except DeviceTimeoutError as still:
                    raise DeviceLostError(
                        f"the device does not answer: {error}, and an abort does not end the frame"
                    ) from still
                raise EngineError(f"the frame was aborted: {error}", ["ABORTED"]) from error
        except (EngineError, InputError):
            raise
        except BaseException as error:
            self._lost = str(error) or type(error).__name__
            raise

    def abort(self) -> None:
        """End the open frame, and receive the rest of it.

        Raises
        ------
        DeviceTimeoutError, DeviceLostError
            If the frame does not end, or the device fails.
        """
        self.set("CONTROL", QUIET=1, ABORT=1)
        self.device.receive()
        self.clear("ERROR")

    def widen(self, beats: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
        """Return beats of a raster with as many limbs as the device's stream has."""
        place = self.registers["CONFIG_1"]["BEAT_BYTES"]
        wide = np.zeros((len(beats), place.reset // 8), np.uint64)
        wide[:, : beats.shape[1]] = beats
        return wide
