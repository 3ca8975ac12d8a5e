"""A LiteX SoC on a ULX3S with an engine of Splatline: a host draws pictures over the UART.

Run as ``.venv/bin/python examples/litex/picture_soc.py``; with ``--build`` it makes the bitstream.
"""

import sys

from litex.soc.cores.dma import WishboneDMAReader, WishboneDMAWriter
from litex.soc.integration.builder import Builder
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import stream, wishbone
from litex_boards.platforms import radiona_ulx3s
from migen.genlib.io import CRG

from splatline.boards.engine_core import EngineCore
from splatline.contract.presets import RGB24

CLOCK = 25_000_000


class PictureSoC(SoCMini):
    """An engine, RAM for a frame's code words and its raster, and a DMA for each of both."""

    def __init__(self, config=RGB24, baud=1_000_000):
        platform = radiona_ulx3s.Platform("LFE5U-85F", revision="2.0", toolchain="trellis")
        self.crg = CRG(platform.request("clk25"), platform.request("rst"))
        super().__init__(platform, CLOCK)
        self.add_uartbone(baudrate=baud)
        self.add_ram("frame", origin=0x1000_0000, size=0x4_0000)

        self.engine = EngineCore(platform, config)
        registers = SoCRegion(origin=0x2000_0000, size=self.engine.bus_bytes, cached=False)
        self.bus.add_slave("engine", self.engine.bus, registers)

        # LiteX calls it "big" if words stay as they are on the bus.
        self.reader = WishboneDMAReader(self._master("reader"), endianness="big", with_csr=True)
        self.writer = WishboneDMAWriter(self._master("writer"), endianness="big", with_csr=True)
        self.codewords = stream.Converter(32, len(self.engine.codewords.data))
        self.raster = stream.Converter(len(self.engine.raster.data), 32)
        self.submodules += stream.Pipeline(self.reader, self.codewords, self.engine.codewords)
        self.submodules += stream.Pipeline(self.engine.raster, self.raster, self.writer)
        self.comb += platform.request("user_led", 0).eq(self.engine.irq)
        self.comb += platform.request("wifi_gpio0").eq(1)  # or the ESP32 resets the FPGA

    def _master(self, name):
        """Return a new master of the bus."""
        master = wishbone.Interface(data_width=32, address_width=32, addressing="word")
        self.bus.add_master(name, master)
        return master


if __name__ == "__main__":
    builder = Builder(PictureSoC(), csr_json="build/ulx3s.json", output_dir="build/ulx3s")
    builder.build(run="--build" in sys.argv)
