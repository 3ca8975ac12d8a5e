"""The Colorlight i5 and i9 on their extension board: SDRAM of 8 MB, HDMI, gigabit Ethernet."""

from __future__ import annotations

from litedram.modules import M12L64322A
from litedram.phy import GENSDRPHY
from liteeth.common import eth_phy_description
from liteeth.phy.ecp5rgmii import LiteEthPHYRGMII
from litex.soc.interconnect import stream
from litex_boards.platforms import colorlight_i5
from migen import ClockDomainsRenamer

from splatline.contract.config import EngineConfig

from .clocks import Clocks
from .screen import SCREEN
from .soc import BoardSoC

__all__ = ["ADDRESS", "PORT", "Colorlight", "add_ethernet"]

ADDRESS, PORT = "192.168.1.50", 1234
"""IP address of the board, and its UDP port."""

CLOCK = 45e6
"""Hz of the system and of the SDRAM, which has 32 bits. Routes reach 50, and gigabit Ethernet needs
31.25 with 32 bits."""

RECEIVED = 125e6
"""Hz of the clock that gigabit Ethernet sends along."""

ETHERBONE_BUFFER = 256
"""32-bit words of a packet that the board can hold: the most that LiteEth allows."""

ETHERNET_BITS = 32
"""Width of LiteEth's data path. With 32 all but the PHY and a converter runs in ``sys``; with 8 it
would run at the 125 MHz of the received clock, and reach 72."""

REVISIONS = {"i5": "7.0", "i9": "7.2"}


class Colorlight(BoardSoC):
    """A Colorlight i5 (LFE5U-25F) or i9 (LFE5U-45F).

    Parameters
    ----------
    config
        The engine's configuration.
    board
        ``i5`` or ``i9``.
    processor
        ``cpu`` and ``program`` of :class:`splatline.boards.soc.BoardSoC`.
    """

    def __init__(self, config: EngineConfig, board: str = "i5", **processor):
        platform = colorlight_i5.Platform(
            board=board, revision=REVISIONS[board], toolchain="trellis"
        )
        clocks = Clocks(
            platform,
            ~platform.request("cpu_reset_n"),
            clk_freq=CLOCK,
            pixel_freq=SCREEN["pix_clk"],
            half_rate=False,
        )
        super().__init__(
            platform,
            clocks,
            config,
            clk_freq=CLOCK,
            phy=GENSDRPHY(platform.request("sdram"), CLOCK),
            module=M12L64322A(CLOCK, "1:1"),
            timings=SCREEN,
            **processor,
        )
        add_ethernet(self, platform.request("eth_clocks", 0), platform.request("eth", 0))
        clocks.rates["eth_clocks0_rx"] = RECEIVED


def add_ethernet(soc, clock_pads, pads):
    """Add the link to a system: a PHY at the pins of RGMII, LiteEth, and Etherbone on the bus."""
    soc.ethernet = LiteEthPHYRGMII(clock_pads=clock_pads, pads=pads, tx_delay=0)
    soc.add_etherbone(
        phy=soc.ethernet, data_width=ETHERNET_BITS, ip_address=ADDRESS, udp_port=PORT,
        buffer_depth=ETHERBONE_BUFFER,
    )  # fmt: skip
    _cut_ready(soc.ethcore_etherbone.mac.core.tx_datapath)


def _cut_ready(datapath):
    """Put registers before and behind the FIFO through which frames leave for the PHY.

    Else ``ready`` goes from the FIFO through all of LiteEth's parts that send in one cycle: the
    longest path of ``sys``.
    """
    pipeline = datapath.pipeline
    (place,) = (
        n for n, part in enumerate(pipeline) if isinstance(part, stream.ClockDomainCrossing)
    )
    layout = eth_phy_description(ETHERNET_BITS)
    before = stream.Buffer(layout, pipe_ready=True)
    behind = ClockDomainsRenamer("eth_tx")(stream.Buffer(layout, pipe_ready=True))
    datapath.submodules += before, behind
    pipeline[place : place + 1] = [before, pipeline[place], behind]
