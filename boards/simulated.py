"""The systems with the pins and the SDRAM of a simulation."""

from __future__ import annotations

from typing import ClassVar

from litedram.common import PhySettings
from litedram.frontend.dma import LiteDRAMDMAReader
from litedram.modules import M12L64322A, MT48LC16M16
from litedram.phy.model import SDRAMPHYModel
from litex.build.generic_platform import Pins, Subsignal
from litex.build.lattice import LatticeECP5Platform
from litex.gen import LiteXModule
from litex.soc.interconnect.csr import CSRStorage
from migen import Cat, ClockDomain, If, Signal
from migen.genlib.resetsync import AsyncResetSynchronizer

from splatline.contract.config import EngineConfig

from . import colorlight, ulx3s
from .memory_map import CSR_PAGES
from .soc import BoardSoC

__all__ = ["BAUD", "BOARDS", "SMALL", "SimulatedSoC"]

BAUD = 12_500_000
"""Bits a second of the link: as fast as its receiver can be, so that simulations are short."""

SMALL = {
    "pix_clk": 25e6,
    "h_active": 160, "h_blanking": 40, "h_sync_offset": 8, "h_sync_width": 16,
    "v_active": 120, "v_blanking": 10, "v_sync_offset": 2, "v_sync_width": 3,
}  # fmt: skip
"""A video mode for quick simulations: 160 x 120 pixels, and blanking as short as may be."""

TRAFFIC = 4
"""Ports of the memory that read all the time, if a test wants that."""

BOARDS = ("ulx3s", "colorlight")
"""Boards that are simulated: each with its clock, its SDRAM and its link."""

PINS = [
    ("clk", 0, *(Subsignal(name, Pins(1)) for name in ("sys", "hdmi", "hdmi5x", "rst"))),
    ("serial", 0, Subsignal("tx", Pins(1)), Subsignal("rx", Pins(1))),
    ("eth_clocks", 0, Subsignal("tx", Pins(1)), Subsignal("rx", Pins(1))),
    ("eth", 0, *(Subsignal(f"{way}_ctl", Pins(1)) for way in ("rx", "tx")),
     *(Subsignal(f"{way}_data", Pins(4)) for way in ("rx", "tx"))),
    ("gpdi", 0, *(Subsignal(f"{name}_p", Pins(1)) for name in ("clk", "data0", "data1", "data2"))),
]  # fmt: skip


def _phy(phytype, bits, phases, latency) -> PhySettings:
    """Return what a PHY of SDR SDRAM tells LiteDRAM."""
    return PhySettings(
        phytype=phytype, memtype="SDR", databits=bits, dfi_databits=bits, nranks=1,
        nphases=phases, rdphase=0, wrphase=0, cl=2, read_latency=latency, write_latency=0,
    )  # fmt: skip


MEMORIES = {
    "ulx3s": (ulx3s.CLOCK, MT48LC16M16, _phy("HalfRateGENSDRPHY", 16, phases=2, latency=2)),
    "colorlight": (colorlight.CLOCK, M12L64322A, _phy("GENSDRPHY", 32, phases=1, latency=3)),
}
"""Of each board the rate of ``sys`` in Hz, the chip of its SDRAM, and what its PHY tells
LiteDRAM."""


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


class Traffic(LiteXModule):
    """Reads SDRAM all the time while ``enable`` is not 0.

    With 1 each port reads from another row each time. With 3 each reads word after word, and the
    arbiter of a bank lets no other port in before such a row is at its end.
    """

    def __init__(self, ports):
        self.enable = CSRStorage(2)
        for number, port in enumerate(ports):
            state = Signal(18, reset=1 + number * 0x1357)  # x^18 + x^11 + 1
            dma = LiteDRAMDMAReader(port, fifo_depth=16)
            self.submodules += dma
            self.comb += [
                dma.sink.valid.eq(self.enable.storage[0]),
                dma.sink.address.eq(state),
                dma.source.ready.eq(1),
            ]
            self.sync += If(
                dma.sink.valid & dma.sink.ready,
                If(self.enable.storage[1], state.eq(state + 1)).Else(
                    state.eq(Cat(state[17] ^ state[10], state))
                ),
            )


class SimulatedSoC(BoardSoC):
    """A board for a simulator: LiteDRAM's model of PHY and chips, and clocks from pins.

    ``sys`` is a clock pin; :attr:`sys_clk_freq` is its rate in Hz.

    Parameters
    ----------
    config
        The engine's configuration.
    timings
        Name of a video mode of LiteX, or one as a dictionary.
    board
        ``ulx3s``: 16 bits of SDRAM at twice the rate of ``sys``, and a serial link;
        ``colorlight``: 32 bits of SDRAM at the rate of ``sys``, and Etherbone from the pins of
        RGMII on.
    refreshes
        Refreshes of the SDRAM for each one that its chips need.
    processor
        ``cpu`` and ``program`` of :class:`splatline.boards.soc.BoardSoC`.
    """

    csr_map: ClassVar = {**CSR_PAGES, "traffic": len(CSR_PAGES)}

    def __init__(
        self, config: EngineConfig, timings="640x480@60Hz", *, board=BOARDS[0], refreshes=1,
        **processor,
    ):  # fmt: skip
        platform = LatticeECP5Platform("LFE5U-85F-6BG381C", PINS, toolchain="trellis")
        clk_freq, module, settings = MEMORIES[board]
        module = module(clk_freq, f"1:{settings.nphases}")
        module.timing_settings.tREFI //= refreshes
        super().__init__(
            platform,
            Clocks(platform),
            config,
            clk_freq=clk_freq,
            phy=SDRAMPHYModel(module, settings=settings, clk_freq=clk_freq),
            module=module,
            timings=timings,
            **processor,
        )
        if board == "colorlight":
            colorlight.add_ethernet(self, platform.request("eth_clocks"), platform.request("eth"))
        else:
            self.add_uartbone(baudrate=BAUD)
        self.traffic = Traffic([self.sdram.crossbar.get_port("read") for _ in range(TRAFFIC)])
