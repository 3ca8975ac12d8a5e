"""Compositor: puts the picture onto the screen, with background about it."""

from __future__ import annotations

from litex.gen import LiteXModule
from litex.soc.cores.video import video_data_layout, video_timing_layout
from litex.soc.interconnect import stream
from migen import Case, ClockDomainsRenamer, If, Module, Signal
from migen.genlib.cdc import MultiReg, PulseSynchronizer

__all__ = ["Compositor"]


class Compositor(LiteXModule):
    """Takes a pixel for each place of the picture, and gives background elsewhere.

    All of it is in the video domain, but for ``underrun``. **Latency**: one pixel. It never stalls.

    Parameters
    ----------
    registers
        Has the registers ``left``, ``top``, ``columns``, ``lines`` and ``background``, which change
        only while nothing is shown, and the signal ``shown``; all in the domain sys.
    video_domain
        Clock domain of the pixels.

    Attributes
    ----------
    timing
        Stream in: LiteX's timing generator.
    pixels
        Stream in: ``data``, 32 bits, red in bits 0..7, green in 8..15, blue in 16..23.
    source
        Stream out: pixels for LiteX's PHY.
    flush : out
        High in the first line of vertical blank: what is left of ``pixels`` is dropped.
    underrun : out
        One cycle of sys for each refresh in which a pixel was missing.
    """

    def __init__(self, registers, video_domain):
        self.timing = timing = stream.Endpoint(video_timing_layout)
        self.pixels = pixels = stream.Endpoint([("data", 32)])
        self.source = source = stream.Endpoint(video_data_layout)
        self.flush = Signal()
        self.underrun = Signal()

        # # #

        values = {}
        for name in ("left", "top", "columns", "lines", "background"):
            storage = getattr(registers, name).storage
            values[name] = Signal(len(storage), name_override=f"video_{name}")
            self.specials += MultiReg(storage, values[name], video_domain)
        shown = Signal()
        self.specials += MultiReg(registers.shown, shown, video_domain)
        missing = Signal()
        self.crossing = PulseSynchronizer(video_domain, "sys")
        self.comb += [self.crossing.i.eq(missing), self.underrun.eq(self.crossing.o)]

        # LiteX's generator numbers columns and lines from 1; 0 is the one before the first.
        draw = Module()
        in_columns, in_lines, inside, broken = Signal(), Signal(), Signal(), Signal()
        draw.comb += [
            timing.ready.eq(1),
            in_columns.eq(
                (timing.hcount > values["left"])
                & (timing.hcount <= values["left"] + values["columns"])
            ),
            in_lines.eq(
                (timing.vcount > values["top"]) & (timing.vcount <= values["top"] + values["lines"])
            ),
            inside.eq(timing.de & in_columns & in_lines & shown),
            pixels.ready.eq(inside & ~broken | self.flush),
            missing.eq(inside & ~broken & ~pixels.valid),
        ]
        background = values["background"]
        draw.sync += [
            self.flush.eq(timing.valid & (timing.vcount == timing.vres + 1)),
            If(self.flush, broken.eq(0)).Elif(missing, broken.eq(1)),
            source.valid.eq(timing.valid),
            source.de.eq(timing.de),
            source.hsync.eq(timing.hsync),
            source.vsync.eq(timing.vsync),
            Case(
                inside & ~broken & pixels.valid,
                {
                    1: [getattr(source, c).eq(pixels.data[8 * n : 8 * n + 8]) for n, c in RGB],
                    0: [getattr(source, c).eq(background[8 * n : 8 * n + 8]) for n, c in RGB],
                },
            ),
        ]
        self.submodules += ClockDomainsRenamer(video_domain)(draw)


RGB = tuple(enumerate("rgb"))
"""Place of each channel in a pixel."""
