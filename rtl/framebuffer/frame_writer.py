"""The frame writer: makes a picture in memory of a raster, in two buffers by turns."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.rtl.bus.axi_stream import RegisterSlice
from splatline.rtl.bus.axi_write import ADDRESS_BITS, AxiWriteSignature
from splatline.rtl.layouts import RasterLayout

from .burst_writer import BURSTS, BurstWriter
from .colour_bytes import colour_bytes
from .layouts import (
    DATA_BITS,
    STRIDE_BITS,
    ColourBeatLayout,
    SettingsLayout,
    bus_pixels,
)
from .raster_scan import RasterScan

__all__ = ["FrameWriter"]


class FrameWriter(wiring.Component):
    """Writes each frame of a raster to one of two buffers, over a background.

    A pixel is 4 bytes: red, green, blue and 0. Its colour has 8 bits a channel, as in the picture
    of ``splatline render`` (:func:`level_byte`). The pixel in column x of line y is at ``buffer +
    stride * y + 4 * x``. Nothing else is written.

    - Drawn pixels have their colour, all others of the image the background's. A line without a
      drawn pixel is skipped if the buffer has background alone there already: see
      :class:`RasterScan`.
    - Every line is written of the first frame in a buffer after a reset; after a change of a
      buffer, the stride, the size or the background; and after a response that is an error.
    - The settings are those in the cycle in which a frame's first beat is taken.
    - A frame goes to the buffer ``swap_index``, 0 after reset. ``swap_valid`` rises once all of it
      is in memory (all responses are in). The display answers with ``swapped`` when it shows this
      buffer. Then the other buffer is next. The next frame's beats wait until then.
    - A frame that ends early is whole: what is missing is background.

    No combinational path leads from an input to an output.

    **Latency**: 5 cycles from a frame's first beat to the first word in the FIFO of bursts; 1 and 2
    from a burst's last word to its address and its first beat; 2 from the last response to
    ``swap_valid``. **Throughput**: a bus word a cycle, and 2 cycles more
    for each line, written or not.

    Parameters
    ----------
    config
        The engine's configuration.
    data_bits
        Bits of the bus: 32, 64 or 128. A word has no more pixels than a beat.
    burst
        Most beats of a burst: a power of two in 2..256.
    outstanding
        Most bursts without a response.

    Members
    -------
    beats : In(stream of RasterLayout)
        The frames.
    buffer_0, buffer_1 : In(32)
        Addresses of the buffers, multiples of the bus's bytes; lower bits are ignored.
    stride : In(16)
        Bytes from a line to the next one, a multiple of the bus's bytes; lower bits are ignored.
    last_column, last_line : In(x_bits), In(line_bits)
        The image's width and height, less 1.
    background : In(24)
        The background's red (lowest), green and blue.
    m_axi : Out(AxiWriteSignature)
        The memory.
    swap_valid : Out(1), swap_index : Out(1), swapped : In(1)
        The picture in a buffer is whole; which buffer; the display shows it from now on.
    frame_done : Out(1)
        High for the cycle before ``swap_valid`` rises.
    error : Out(1)
        A response was an error; high until the reset.

    Raises
    ------
    ValueError
        If the bus or a burst has another size, or if a word has more pixels than a beat.
    """

    def __init__(
        self,
        config: EngineConfig = PAPER,
        data_bits: int = 64,
        *,
        burst: int = 64,
        outstanding: int = 8,
    ):
        if data_bits not in DATA_BITS:
            raise ValueError(f"the bus must have 32, 64 or 128 bits, not {data_bits!r}")
        if bus_pixels(data_bits) > config.raster_pixels:
            raise ValueError(
                f"a bus of {data_bits} bits has {bus_pixels(data_bits)} pixels a word,"
                f" and a beat of {config.name!r} has {config.raster_pixels}"
            )
        if burst not in BURSTS:
            raise ValueError(f"a burst must have 2, 4, .. 256 beats, not {burst!r}")
        self.config, self.data_bits = config, data_bits
        self.scan = RasterScan(config, data_bits)
        self.writer = BurstWriter(data_bits, burst, outstanding)
        super().__init__(
            {
                "beats": In(stream.Signature(RasterLayout(config))),
                "buffer_0": In(ADDRESS_BITS),
                "buffer_1": In(ADDRESS_BITS),
                "stride": In(STRIDE_BITS),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
                "background": In(24),
                "m_axi": Out(AxiWriteSignature(data_bits)),
                "swap_valid": Out(1),
                "swap_index": Out(1),
                "swapped": In(1),
                "frame_done": Out(1),
                "error": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.scan = scan = self.scan
        m.submodules.writer = writer = self.writer
        taken = Signal()
        opened = Signal()  # a beat of the frame has been taken
        ended = Signal()  # and its end beat
        back = Signal()
        opening = Signal()
        settings = Signal(SettingsLayout(self.config), reset_less=True)
        m.submodules.slice = slice_ = RegisterSlice(ColourBeatLayout(self.config))
        m.d.comb += [
            self.beats.ready.eq(slice_.i.ready & ~ended),
            taken.eq(self.beats.valid & self.beats.ready),
            opening.eq(taken & ~opened),
            slice_.i.valid.eq(self.beats.valid & ~ended),
            scan.settings.eq(settings),
            scan.buffer.eq(back),
            self.swap_index.eq(back),
        ]
        self._drop_depth(m, slice_.i.payload)
        connect(m, slice_.o, scan.beats)
        with m.If(taken):
            m.d.sync += [opened.eq(1), ended.eq(self.beats.payload.end)]
        m.d.sync += scan.start.eq(opening)

        changed = self._settings(m, settings, opening)
        draining = Signal()
        ready = Signal()
        whole = Signal()
        m.d.comb += [
            whole.eq(draining & ~scan.words.valid & writer.idle),
            self.frame_done.eq(whole),
            self.swap_valid.eq(ready),
        ]
        with m.If(scan.done):
            m.d.sync += draining.eq(1)
        with m.If(whole):
            m.d.sync += [draining.eq(0), ready.eq(1)]
        with m.If(ready & self.swapped):
            m.d.sync += [ready.eq(0), opened.eq(0), ended.eq(0), back.eq(~back)]

        self._rewrites(m, back, opening, changed, whole)
        self._words(m, settings)
        connect(m, writer.bus, flipped(self.m_axi))
        return m

    def _drop_depth(self, m, shown):
        """Make a beat without depth of the one that comes."""
        beat, background = self.beats.payload, self.config.background_depth
        m.d.comb += [
            shown.colour.eq(beat.pixels.colour),
            shown.drawn.eq(
                Cat(
                    beat.pixels.depth[pixel] != background
                    for pixel in range(self.config.raster_pixels)
                )
            ),
            shown.word.eq(beat.word),
            shown.line.eq(beat.line),
            shown.end.eq(beat.end),
        ]

    def _settings(self, m, settings, opening):
        """Take the settings of a frame that opens; return whether they have changed."""
        now = Signal(settings.shape(), name="settings_now")
        changed = Signal()
        m.d.comb += [
            now.buffers.eq(Cat(self.buffer_0, self.buffer_1)),
            now.stride.eq(self.stride),
            now.last_column.eq(self.last_column),
            now.last_line.eq(self.last_line),
            now.background.eq(self.background),
            changed.eq(now.as_value() != settings.as_value()),
        ]
        with m.If(opening):
            m.d.sync += settings.eq(now)
        return changed

    def _rewrites(self, m, back, opening, changed, whole):
        """Keep which buffers hold what is not known, so that every line is written."""
        unknown = Signal(2, init=0b11)
        failed = Signal()  # in this frame
        m.d.comb += self.scan.rewrite.eq(unknown.bit_select(back, 1))
        with m.If(self.writer.failed):
            m.d.sync += [self.error.eq(1), failed.eq(1)]
        with m.If(opening):
            m.d.sync += failed.eq(0)
            with m.If(changed):
                m.d.sync += unknown.eq(0b11)
        with m.If(whole):
            m.d.sync += unknown.bit_select(back, 1).eq(failed)

    def _words(self, m, settings):
        """Turn colours into bytes, with the background where nothing is drawn."""
        scanned, word = self.scan.words, self.writer.words.payload
        pixels = bus_pixels(self.data_bits)
        for pixel in range(pixels):
            rgb = Cat(colour_bytes(scanned.payload.colour[pixel], self.config))
            drawn = scanned.payload.drawn[pixel]
            m.d.comb += word.rgb[pixel].eq(Mux(drawn, rgb, settings.background))
        last = settings.last_column[: (pixels - 1).bit_length()]
        m.d.comb += [
            word.address.eq(scanned.payload.address),
            word.last.eq(scanned.payload.last),
            self.writer.words.valid.eq(scanned.valid),
            scanned.ready.eq(self.writer.words.ready),
            self.writer.last_pixels.eq(Cat(Const(pixel) <= last for pixel in range(pixels))),
        ]
