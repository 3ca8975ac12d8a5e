"""Draws two pictures with the example SoC over its UART, and compares them with golden.

Run as ``.venv/bin/python examples/litex/draw_picture.py build/ulx3s.json /dev/ttyUSB0``.
"""

import json
import sys
from pathlib import Path

import numpy as np

from splatline.boards.uart_link import open_serial
from splatline.contract.beat_layout import raster_stream_bytes
from splatline.host.device.device import DeviceTimeoutError
from splatline.host.device.driver import Engine, read_config
from splatline.sim import golden
from splatline.sim.cosim.standalone.frames import bench_frames

BAUD = 1_000_000
TRIES = 1000
"""Looks at a DMA before a picture counts as late."""


class SocDevice:
    """The SoC as a device for :class:`splatline.host.device.driver.Engine`.

    Parameters
    ----------
    link
        Reads and writes words on the SoC's bus.
    told
        What LiteX's builder wrote of the SoC as JSON.
    """

    def __init__(self, link, told):
        self.link, self.registers = link, told["csr_registers"]
        self.engine = told["memories"]["engine"]["base"]
        frame = told["memories"]["frame"]
        self.half = frame["size"] // 2  # for code words; the raster comes behind them
        self.codewords, self.raster = frame["base"], frame["base"] + self.half
        self.limbs = raster_stream_bytes(read_config(self)) // 8

    def read32(self, offset):
        """Return a register of the engine."""
        return int(self.link.read(self.engine + offset)[0])

    def write32(self, offset, value):
        """Write a register of the engine."""
        self.write_words(offset, np.array([value], np.uint32))

    def write_words(self, offset, words):
        """Write registers of the engine that follow each other."""
        self.link.write(self.engine + offset, words)

    def send(self, codewords, initial=None):
        """Write a frame's code words into the RAM, and start both DMAs."""
        if initial is not None or codewords.nbytes > self.half:
            raise ValueError("a frame starts from background, and its code words fit the RAM")
        self.link.write(self.codewords, codewords.view(np.uint32).ravel())
        self._start("writer", self.raster, self.half)
        self._start("reader", self.codewords, codewords.nbytes)

    def receive(self):
        """Wait until the raster is in the RAM, and read it."""
        for _ in range(TRIES):
            if self._get("writer_done"):
                words = self.link.read(self.raster, self._get("writer_offset"))
                return words.view(np.uint64).reshape(-1, self.limbs)
        raise DeviceTimeoutError("the raster did not end in time")

    def _start(self, dma, base, size):
        """Start a DMA; it forgets its last run while it is disabled."""
        for name, value in ("enable", 0), ("base", base), ("length", size), ("enable", 1):
            place = self.registers[f"{dma}_{name}"]
            # Of a register of several words LiteX has the highest first.
            words = np.frombuffer(value.to_bytes(4 * place["size"], "big"), ">u4")
            self.link.write(place["addr"], words)

    def _get(self, name):
        """Return a register of LiteX."""
        return int(self.link.read(self.registers[name]["addr"])[0])


def main(link, told):
    """Draw two frames; return 0 if every pixel is golden's."""
    engine = Engine(SocDevice(link, told))
    unlike = 0
    for frame in bench_frames(engine.config):
        engine.write_tables(frame.tables, frame.width, frame.height)
        raster = engine.draw(frame.codewords)
        unlike += (wrong := raster.mismatches(golden.render(frame)))
        drawn = int(raster.drawn.sum())
        print(f"{len(frame.codewords)} code words, {drawn} pixels, {wrong} unlike golden")
    return int(unlike > 0)


if __name__ == "__main__":
    file, port = sys.argv[1:]
    sys.exit(main(open_serial(port, BAUD), json.loads(Path(file).read_text())))
