"""The same system with the pins and the SDRAM of a simulation."""

from __future__ import annotations

from litedram.common import PhySettings
from litedram.modules import MT48LC16M16
from litedram.phy.model import SDRAMPHYModel
from litex.build.generic_platform import Pins, Subsignal
from litex.build.lattice import LatticeECP5Platform
from litex.gen import LiteXModule
from migen import ClockDomain, Signal
from migen.genlib.resetsync import AsyncResetSynchronizer

from splatline.contract.config import EngineConfig

from .soc import BoardSoC

__all__ = ["SMALL", "SimulatedSoC"]

SMALL = {
    "pix_clk": 25e6,
    "h_active": 160, "h_blanking": 40, "h_sync_offset": 8, "h_sync_width": 16,
    "v_active": 120, "v_blanking": 10, "v_sync_offset": 2, "v_sync_width": 3,
}  # fmt: skip
"""A video mode for quick simulations: 160 x 120 pixels, and blanking as short as may be."""

PINS = [
    ("clk", 0, *(Subsignal(name, Pins(1)) for name in ("sys", "hdmi", "hdmi5x", "rst"))),
    ("serial", 0, Subsignal("tx", Pins(1)), Subsignal("rx", Pins(1))),
    ("gpdi", 0, *(Subsignal(f"{name}_p", Pins(1)) for name in ("clk", "data0", "data1", "data2"))),
]


class Clocks(LiteXModule):
    """The clock domains from pins, and the reset of each."""

    def __init__(self, platform):
        self.rst = Signal()
        pads = platform.request("clk")
        for name in ("sys", "hdmi", "hdmi5x"):
            domain = ClockDomain(name)
            setattr(self, f"cd_{name}", domain)
            self.comb += domain.clk.eq(getattr(pads, name))
            self.specials += AsyncResetSynchronizer(domain, pads.rst | self.rst)


class SimulatedSoC(BoardSoC):
    """A ULX3S for a simulator: LiteDRAM's model of PHY and chips, and clocks from pins.

    Parameters
    ----------
    config
        The engine's configuration.
    timings
        Name of a video mode of LiteX, or one as a dictionary.
    baud
        Bits a second of the link.
    clk_freq
        Hz of ``sys``.
    """

    def __init__(self, config: EngineConfig, timings="640x480@60Hz", baud=6_250_000, clk_freq=50e6):
        platform = LatticeECP5Platform("LFE5U-85F-6BG381C", PINS, toolchain="trellis")
        module = MT48LC16M16(clk_freq, "1:2")
        super().__init__(
            platform,
            Clocks(platform),
            config,
            clk_freq=clk_freq,
            phy=SDRAMPHYModel(module, settings=phy_settings(), clk_freq=clk_freq),
            module=module,
            timings=timings,
        )
        self.add_uartbone(baudrate=baud)


def phy_settings() -> PhySettings:
    """Return what LiteDRAM's HalfRateGENSDRPHY with 16 bits has as its settings."""
    return PhySettings(
        phytype="HalfRateGENSDRPHY", memtype="SDR", databits=16, dfi_databits=16, nranks=1,
        nphases=2, rdphase=0, wrphase=0, cl=2, read_latency=2, write_latency=0,
    )  # fmt: skip
