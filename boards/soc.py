"""The system: a link, SDRAM, an engine, a player and a screen. It needs no processor."""

from __future__ import annotations

from typing import ClassVar

from litex.soc.cores.video import VideoHDMIPHY, VideoTimingGenerator, video_timings
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from migen import ClockDomainsRenamer

from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig

from .engine_core import EngineCore
from .memory_map import CSR_PAGES, ENGINE, ENGINE_BYTES, FRAME_LIST, FRAME_LIST_BYTES, MAIN_RAM
from .player import Player
from .processor import IDLE, REGISTERS, processor_options
from .scanout import ScanOut

__all__ = ["BoardSoC"]

VIDEO = "hdmi"
"""Clock domain of the pixels; the serialisers run in ``hdmi5x``."""


class BoardSoC(SoCMini):
    """The whole of a board's gateware, but for clocks, pins and the link.

    A host initialises the SDRAM over the link, uploads code words, and starts the player
    (:class:`splatline.boards.board.Board`).

    All masters of the SDRAM have ports of 32 bits: the link, code words, the engine's pictures, and
    the screen. While the screen is hungry, code words and pictures wait.

    Parameters
    ----------
    platform
        A LiteX platform with the pins ``gpdi``.
    clocks
        Makes the clock domains ``sys``, ``hdmi`` and ``hdmi5x``; has ``rst``.
    config
        The engine's configuration.
    clk_freq
        Hz of ``sys``.
    phy, module
        LiteDRAM's PHY, with 32 bits a cycle of ``sys``, and its description of the chips.
    timings
        Name of a video mode of LiteX, or one as a dictionary.
    scan_depth
        Pixels that are read ahead of the screen.
    cpu
        One of :data:`splatline.boards.processor.PROCESSORS`, or None. It is a master of the bus, as
        the link is.
    program
        Its program.
    """

    csr_map: ClassVar = CSR_PAGES

    def __init__(
        self, platform, clocks, config: EngineConfig, *, clk_freq, phy, module, timings,
        scan_depth=2048, cpu=None, program=IDLE,
    ):  # fmt: skip
        self.crg = clocks
        self.config_name = config.name
        self.registers = 0 if cpu is None else REGISTERS
        self.mem_map = {**SoCMini.mem_map, "csr": self.registers, "main_ram": MAIN_RAM}
        super().__init__(platform, int(clk_freq), **processor_options(cpu, program))
        self.sdrphy = phy
        # Without a cache: the link's writes must be seen by the other masters.
        self.add_sdram("sdram", phy=phy, module=module, l2_cache_size=0)
        memory = self.sdram.crossbar
        self.timings = video_timings[timings] if isinstance(timings, str) else timings

        self.scanout = ScanOut(memory.get_port("read", data_width=32), VIDEO, depth=scan_depth)
        self.engine = EngineCore(platform, config, memory.get_port("write", data_width=32))
        self.player = Player(
            memory.get_port("read", data_width=32), 8 * codeword_stream_bytes(config)
        )
        self._connect()
        self._screen()
        self.bus.add_slave(
            "engine", self.engine.bus, _region(self.registers + ENGINE, ENGINE_BYTES)
        )
        frame_list = _region(self.registers + FRAME_LIST, FRAME_LIST_BYTES)
        self.bus.add_slave("frame_list", self.player.bus, frame_list)

    def _connect(self):
        """Connect player, engine and scan-out."""
        self.comb += [
            self.player.source.connect(
                self.engine.codewords, keep={"valid", "ready", "data", "last"}
            ),
            self.engine.buffer_0.eq(self.scanout.buffer_0.storage),
            self.engine.buffer_1.eq(self.scanout.buffer_1.storage),
            self.engine.stride.eq(self.scanout.stride.storage[:16]),
            self.engine.background.eq(self.scanout.background.storage),
            self.scanout.swap_valid.eq(self.engine.swap_valid),
            self.scanout.swap_index.eq(self.engine.swap_index),
            self.engine.swapped.eq(self.scanout.swapped),
            self.player.swapped.eq(self.scanout.swapped),
            self.player.refreshed.eq(self.scanout.refreshed),
            self.player.pause.eq(self.scanout.hungry),
            self.engine.pause.eq(self.scanout.hungry),
        ]

    def _screen(self):
        """Add LiteX's timing generator and serialisers."""
        self.video_timing = ClockDomainsRenamer(VIDEO)(VideoTimingGenerator(self.timings))
        self.video_phy = VideoHDMIPHY(self.platform.request("gpdi"), clock_domain=VIDEO)
        self.comb += [
            self.video_timing.source.connect(self.scanout.timing),
            self.scanout.source.connect(self.video_phy.sink),
        ]


def _region(origin, size):
    return SoCRegion(origin=origin, size=size, cached=False)
