"""Files and pipes in place of a board: the registers are plain memory, the engine is golden.

What it knows of the registers it has from the JSON map, and what it reads of the tables it takes
from the file bit by bit: not from the driver that is under test.
"""

import contextlib
import os
import threading

import numpy as np

from splatline.contract.frame import Frame, Tables
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.contract.register_map import register_map
from splatline.flow.register_texts import json_map
from splatline.sim import golden
from tests.support.bus_words import decoded

__all__ = ["FakeBoard"]


class FakeBoard:
    """A card in a folder: ``FakeBoard(folder, config).card`` is what its files begin with."""

    def __init__(self, folder, config):
        self.config = config
        self.map = json_map(register_map(config))
        self.card = str(folder / "xdma0")
        self.memory = folder / "xdma0_user"
        self.word_bytes = self.map["streams"]["codeword_bytes"]
        self.offsets = {row["name"]: row["offset"] for row in self.map["registers"]}
        image = bytearray(self.map["bytes"])
        for row in self.map["registers"]:
            word = sum(field.get("reset", 0) << field["lsb"] for field in row["fields"])
            image[row["offset"] : row["offset"] + 4] = word.to_bytes(4, "little")
        self.memory.write_bytes(image)
        self.pipes = {}
        for name in ("_h2c_0", "_h2c_1", "_c2h_0"):
            os.mkfifo(self.card + name)
            self.pipes[name] = os.open(self.card + name, os.O_RDWR)
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def close(self):
        """End: an end word of its own, which nobody waits for, wakes the engine."""
        self.closing = True
        os.write(self.pipes["_h2c_0"], bytes(self.word_bytes))
        self.thread.join()
        for pipe in self.pipes.values():
            os.close(pipe)

    closing = False

    def read(self, pipe, count):
        """Exactly so many bytes of a pipe."""
        data = b""
        while len(data) < count:
            data += os.read(self.pipes[pipe], count - len(data))
        return data

    def serve(self):
        """Draw frame after frame."""
        words = []
        with contextlib.suppress(OSError):
            while True:
                limbs = np.frombuffer(self.read("_h2c_0", self.word_bytes), "<u8")
                words.append(limbs if self.config.plane else limbs[0])
                if self.closing:
                    return
                if decoded(np.array(words[-1:], np.uint64), self.config)["end"][0]:
                    self.draw(words)
                    words = []

    def draw(self, words):
        """Draw a frame with what stands in the registers, and send it in two pieces."""
        image = self.memory.read_bytes()

        def word(offset):
            return int.from_bytes(image[offset : offset + 4], "little")

        window = self.map["materials"]
        kd_ks = np.zeros((2, window["entries"], 3), np.int64)
        for entry in range(window["entries"]):
            base = window["offset"] + entry * window["stride"]
            bits = sum(word(base + 4 * n) << 32 * n for n in range(window["words"]))
            for n, field in enumerate(window["fields"]):
                value = bits >> field["lsb"] & (1 << field["width"]) - 1
                kd_ks[n // 3, entry, n % 3] = value
        ambient = [word(self.offsets[f"AMBIENT_{name}"]) for name in ("RED", "GREEN", "BLUE")]
        width, height = (word(self.offsets[name]) + 1 for name in ("LAST_COLUMN", "LAST_LINE"))
        tables = Tables(np.array(ambient, np.int64), *kd_ks)
        frame = Frame(np.array(words, np.uint64), tables, width, height, self.config)
        start = self.start(width, height) if word(self.offsets["START"]) else None
        beats = to_beats(golden.render(frame, start))
        wide = np.zeros((len(beats), self.map["streams"]["raster_bytes"] // 8), np.uint64)
        wide[:, : beats.shape[1]] = beats
        data = wide.tobytes()
        for part in (data[:37], data[37:]):
            os.write(self.pipes["_c2h_0"], part)

    def start(self, width, height):
        """The initial raster, read up to its end beat."""
        size = self.map["streams"]["raster_bytes"]
        beats = []
        while not beats or not int(beats[-1]) >> self.config.raster_end.lsb & 1:
            beats.append(int.from_bytes(self.read("_h2c_1", size), "little"))
        limbs = -(-self.config.raster_end.end // 64)
        rows = [[beat >> 64 * n & (1 << 64) - 1 for n in range(limbs)] for beat in beats]
        return from_beats(np.array(rows, np.uint64), width, height, self.config)
