"""A script of accesses, packets and pictures on the AXI top, as an act of the bench."""

import numpy as np

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.register_map import register_map

from .program import ANY_LEVEL, LAST_OF_FRAME, RASTER_STALLS, Act, Items

__all__ = ["DECERR", "OKAY", "SLVERR", "Script"]

OKAY, SLVERR, DECERR = 0, 2, 3
FULL = (1 << 32) - 1
NAMES = ("aw", "w", "ar", "codewords", "initial", "poke", "b", "r", "raster")


class Script:
    """What goes over the ports, one after the other: accesses wait for the answers before them.

    Packets wait for the accesses before them, and accesses for packets and pictures where
    :meth:`settle` or :meth:`sent` says so.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        self.map = register_map(config)
        self.rows = {name: [] for name in NAMES}
        self.waits = dict.fromkeys(NAMES, 0)

    def _add(self, name: str, value: int, mask: int = 0, flags: int = 0, **more: int) -> None:
        self.rows[name].append((value, mask, flags, {**self.waits, **more}))

    def offset(self, name: str) -> int:
        """Return the address of a register."""
        return self.map[name].offset

    def bits(self, name: str, *fields: str) -> int:
        """Return ones in some fields of a register."""
        return sum(
            field.place.mask << field.place.lsb
            for field in self.map[name].fields
            if field.name in fields
        )

    def answered(self) -> None:
        """Let all that follows wait for the answers so far."""
        for name in ("b", "r"):
            self.waits[name] = len(self.rows[name])

    def write(
        self, address: int | str, value: int, answer: int = OKAY, strobe: int = 15,
        *, at_once: bool = False,
    ) -> None:  # fmt: skip
        """Write a register, and expect an answer; ``at_once``: what follows may overtake it."""
        address = self.offset(address) if isinstance(address, str) else address
        self._add("aw", address)
        self._add("w", value | strobe << 32)
        both = {name: len(self.rows[name]) for name in ("aw", "w")}
        self._add("b", answer, 3, ANY_LEVEL, **both)
        if not at_once:
            self.answered()

    def read(
        self, address: int | str, value: int = 0, mask: int = FULL, answer: int = OKAY,
        level: int = 2, stalls: bool = False, at_once: bool = False,
    ) -> None:  # fmt: skip
        """Read a register, and expect bits of its value, an answer, and a level of ``irq``."""
        address = self.offset(address) if isinstance(address, str) else address
        self._add("ar", address)
        flags = level << 1 | (RASTER_STALLS if stalls else 0)
        self._add("r", value | answer << 32, mask | 3 << 32, flags, ar=len(self.rows["ar"]))
        if not at_once:
            self.answered()

    def poke(self, value: int) -> None:
        """Set all counters, once all that comes before is done; what follows waits for it."""
        self._add("poke", value)
        self.sent("poke")

    def wait(self, reads: int = 6) -> None:
        """Let some cycles pass, by reads of STATUS of which nothing counts but the answer."""
        for _ in range(reads):
            self.read("STATUS", 0, 0)

    def errors(self, *names: str, clear: bool = True) -> None:
        """Expect ERROR to have these bits, and clear them."""
        self.read("ERROR", self.bits("ERROR", *names))
        if clear:
            self.write("ERROR", FULL)
            self.read("ERROR", 0)

    def packet(self, name: str, words, keep=None, last: bool = True) -> None:
        """Send words on a stream; ``keep`` has a byte for each byte, ``last``: TLAST at the end."""
        config = self.config
        size = codeword_stream_bytes(config) if name == "codewords" else raster_stream_bytes(config)
        words = np.asarray(words, np.uint64)
        rows = words.reshape(len(words), -1)
        for number, row in enumerate(rows):
            value = sum(int(limb) << 64 * n for n, limb in enumerate(row))
            kept = (1 << size) - 1
            if keep is not None:
                kept = sum(int(bit) << n for n, bit in enumerate(keep[number]))
            ends = last and number == len(rows) - 1
            value |= kept << 8 * size | int(ends) << 9 * size
            self._add(name, value, flags=LAST_OF_FRAME if ends else 0)

    def picture(self, beats) -> None:
        """Expect the beats of a picture; of the last one the end bit counts."""
        config = self.config
        size = raster_stream_bytes(config)
        every = (1 << 8 * size) - 1
        kept = ((1 << size) - 1) << 8 * size
        last = 1 << 9 * size
        for number, row in enumerate(beats):
            value = sum(int(limb) << 64 * n for n, limb in enumerate(row)) | kept
            mask = every | kept | last
            if number == len(beats) - 1:
                value |= last
                mask = 1 << config.raster_end.lsb | kept | last
            self._add("raster", value, mask, ANY_LEVEL)

    def settle(self) -> None:
        """Let all that follows wait for the pictures so far."""
        self.waits["raster"] = len(self.rows["raster"])

    def sent(self, *names: str) -> None:
        """Let all that follows wait until the packets so far of some streams are taken."""
        for name in names:
            self.waits[name] = len(self.rows[name])

    def act(self, kind: str, stalls=({}, {}), **options) -> Act:
        """Return the act."""
        items = {}
        for name, rows in self.rows.items():
            if not rows:
                continue
            most = max(max(value, mask) for value, mask, _, _ in rows)
            limbs = max(1, -(-most.bit_length() // 64))
            waits = {each: np.array([row[3][each] for row in rows]) for each in NAMES}
            items[name] = Items(
                _limbs([row[0] for row in rows], limbs),
                _limbs([row[1] for row in rows], limbs),
                {each: after for each, after in waits.items() if after.any()},
                flags=np.array([row[2] for row in rows]),
            )
        return Act(kind, items, *stalls, **options)


def _limbs(values: list[int], limbs: int):
    """Return integers as limbs."""
    part = (1 << 64) - 1
    return np.array([[v >> 64 * n & part for n in range(limbs)] for v in values], np.uint64)
