"""The ULX3S with an LFE5U-85F: SDRAM of 32 MB, HDMI (GPDI), a serial link over USB."""

from __future__ import annotations

from litedram.modules import MT48LC16M16
from litedram.phy import HalfRateGENSDRPHY
from litex_boards.platforms import radiona_ulx3s

from splatline.contract.config import EngineConfig

from .catalog import BAUD
from .clocks import Clocks
from .screen import SCREEN
from .soc import BoardSoC

__all__ = ["Ulx3s"]

CLOCK = 50e6
"""Hz of the system. The SDRAM runs at twice this rate, with 16 bits."""


class Ulx3s(BoardSoC):
    """A ULX3S, revision 2.0 and later. The button F1 resets it.

    Parameters
    ----------
    config
        The engine's configuration.
    timings
        The video mode.
    baud
        Bits a second of the serial link.
    processor
        ``cpu`` and ``program`` of :class:`splatline.boards.soc.BoardSoC`.
    """

    def __init__(self, config: EngineConfig, timings=SCREEN, baud=BAUD, **processor):
        platform = radiona_ulx3s.Platform("LFE5U-85F", revision="2.0", toolchain="trellis")
        clocks = Clocks(
            platform,
            platform.request("rst"),
            clk_freq=CLOCK,
            pixel_freq=timings["pix_clk"],
            half_rate=True,
        )
        super().__init__(
            platform,
            clocks,
            config,
            clk_freq=CLOCK,
            phy=HalfRateGENSDRPHY(platform.request("sdram"), CLOCK),
            module=MT48LC16M16(CLOCK, "1:2"),
            timings=timings,
            **processor,
        )
        self.comb += platform.request("wifi_gpio0").eq(1)  # or the ESP32 resets the FPGA
        self.add_uartbone(baudrate=baud)
