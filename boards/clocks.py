"""Clocks of an ECP5 board with an oscillator of 25 MHz."""

from __future__ import annotations

from litex.build.io import DDROutput
from litex.gen import LiteXModule
from litex.soc.cores.clock import ECP5PLL
from migen import ClockDomain, ClockSignal, Signal

__all__ = ["OSCILLATOR", "Clocks"]

OSCILLATOR = 25e6
"""Hz."""

SDRAM_PHASE = 180
"""Degrees by which the chips' clock is behind, as LiteX's targets of both boards have it."""


class Clocks(LiteXModule):
    """The domains ``sys``, ``hdmi`` and ``hdmi5x``, and the SDRAM's clock.

    Parameters
    ----------
    platform
        A platform with the pins ``clk25`` and ``sdram_clock``.
    reset
        Signal of the reset button, active high.
    clk_freq
        Hz of ``sys``.
    pixel_freq
        Hz of ``hdmi``; it is met exactly, and ``hdmi5x`` is five times as fast.
    half_rate
        The SDRAM runs at twice the rate of ``sys``, in the domain ``sys2x``.

    Attributes
    ----------
    names
        The domains by LiteX's names of the PLLs' outputs.
    rates
        Hz of each domain that has logic.
    """

    def __init__(self, platform, reset, *, clk_freq, pixel_freq, half_rate):
        self.rst = Signal()
        self.names = {}
        self.rates = {"sys": clk_freq, "hdmi": pixel_freq, "hdmi5x": 5 * pixel_freq}
        self.cd_sys, self.cd_hdmi, self.cd_hdmi5x = (
            ClockDomain(name) for name in ("sys", "hdmi", "hdmi5x")
        )
        clk25 = platform.request("clk25")
        self.pll = pll = ECP5PLL()
        self.video_pll = video_pll = ECP5PLL()
        for one in (pll, video_pll):
            self.comb += one.reset.eq(reset | self.rst)
            one.register_clkin(clk25, OSCILLATOR)
        pll.create_clkout(self.cd_sys, clk_freq)
        name = "sys2x_ps" if half_rate else "sys_ps"
        delayed = ClockDomain(name)
        setattr(self, f"cd_{name}", delayed)
        if half_rate:
            self.cd_sys2x = ClockDomain("sys2x")
            self.rates["sys2x"] = 2 * clk_freq
            pll.create_clkout(self.cd_sys2x, 2 * clk_freq)
        pll.create_clkout(delayed, (2 if half_rate else 1) * clk_freq, phase=SDRAM_PHASE)
        video_pll.create_clkout(self.cd_hdmi, pixel_freq, margin=0)
        video_pll.create_clkout(self.cd_hdmi5x, 5 * pixel_freq, margin=0)
        for number, outputs in enumerate(
            (["sys", *(["sys2x"] * half_rate), name], ["hdmi", "hdmi5x"])
        ):
            for place, domain in enumerate(outputs):
                self.names[f"ecp5pll{number}_clkout{place}"] = domain
        self.specials += DDROutput(1, 0, platform.request("sdram_clock"), ClockSignal(name))
