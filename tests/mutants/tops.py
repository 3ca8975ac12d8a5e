"""The designs that are mutated, and their ports as channels of the bench."""

import re
from dataclasses import dataclass
from functools import cache

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.presets import get_preset
from splatline.flow.tops import TOPS

__all__ = ["DESIGNS", "ENGINE", "Channel", "Design", "wrapper"]

ENGINE = "splatline__engine"
"""Module of the engine in an AXI top."""


@dataclass(frozen=True)
class Channel:
    """A stream of a design.

    Parameters
    ----------
    name
        Name in the bench.
    ports
        Names and widths of its payload's ports, lowest bits first.
    valid, ready
        Names of its other ports.
    """

    name: str
    ports: tuple[tuple[str, int], ...]
    valid: str
    ready: str

    @property
    def width(self) -> int:
        """Bits of the payload."""
        return sum(width for _, width in self.ports)


@dataclass(frozen=True)
class Design:
    """A top module of a preset.

    Parameters
    ----------
    preset
        Name of the preset.
    top
        ``engine`` or ``axi``.
    inside
        The top that the engine is a part of and is taken from; empty if it is the top.
    """

    preset: str
    top: str = "engine"
    inside: str = ""

    @property
    def name(self) -> str:
        """Name in tables and options: ``paper``, or ``paper-axi``."""
        if self.inside:
            return f"{self.outer.name}-engine"
        return self.preset if self.top == "engine" else f"{self.preset}-{self.top}"

    @property
    def outer(self) -> "Design":
        """The design that this one is taken from."""
        return Design(self.preset, self.inside)

    @property
    def engine(self) -> "Design":
        """The engine of an AXI top, as a design of its own."""
        return Design(self.preset, inside=self.top)

    @property
    def config(self) -> EngineConfig:
        """Configuration of the engine."""
        return get_preset(self.preset)

    @cache  # noqa: B019  designs are few, and live as long as the process
    def verilog(self) -> str:
        """Return the Verilog; the top module is ``splatline``."""
        return TOPS[self.inside or self.top](self.config, "splatline")[0]

    @property
    def inputs(self) -> tuple[Channel, ...]:
        """Streams into the design, in the bench's order."""
        config = self.config
        if self.top == "engine":
            widths = {
                "tables": config.table_address.end,
                "codewords": config.codeword_bits,
                "initial": config.raster_end.end,
            }
            stream = self._stream_inside if self.inside else _stream
            return tuple(stream(name, width) for name, width in widths.items())
        return (
            _axi("s_axi_ctrl", "aw", "awaddr", 14, "aw"),
            Channel(
                "w",
                (("s_axi_ctrl_wdata", 32), ("s_axi_ctrl_wstrb", 4)),
                "s_axi_ctrl_wvalid",
                "s_axi_ctrl_wready",
            ),
            _axi("s_axi_ctrl", "ar", "araddr", 14, "ar"),
            _packets("s_axis_codewords", codeword_stream_bytes(config)),
            _packets("s_axis_initial", raster_stream_bytes(config)),
            Channel("poke", (("poke_value", 32),), "poke", "poke_ready"),
        )

    def _stream_inside(self, name: str, width: int) -> Channel:
        """Return a stream into an engine that is a part: its ports are found by their widths."""
        text = self.verilog()
        text = text[text.index(f"module {ENGINE}(") :]
        found = re.search(rf"input \[{width - 1}:0\] ((?:{name}|i)__payload\w*);", text)
        valid = found[1].replace("payload", "valid")
        return Channel(name, ((found[1], width),), valid, f"{name}__ready")

    @property
    def outputs(self) -> tuple[Channel, ...]:
        """Streams out of the design, in the bench's order."""
        if self.top == "engine":
            return (_stream("raster", self.config.raster_end.end),)
        return (
            _axi("s_axi_ctrl", "b", "bresp", 2, "b"),
            Channel(
                "r",
                (("s_axi_ctrl_rdata", 32), ("s_axi_ctrl_rresp", 2)),
                "s_axi_ctrl_rvalid",
                "s_axi_ctrl_rready",
            ),
            _packets("m_axis_raster", raster_stream_bytes(self.config)),
        )

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All streams, those into the design first."""
        return self.inputs + self.outputs

    @property
    def payload_words(self) -> int:
        """Words of 32 bits of the widest payload, at least three: Verilator's wide signals."""
        return max(3, -(-max(channel.width for channel in self.channels) // 32))


def _stream(name: str, width: int) -> Channel:
    """Return a stream of Amaranth's."""
    return Channel(name, ((f"{name}__payload", width),), f"{name}__valid", f"{name}__ready")


def _axi(prefix: str, name: str, payload: str, width: int, channel: str) -> Channel:
    """Return a channel of AXI4-Lite with one payload."""
    ports = ((f"{prefix}_{payload}", width),)
    return Channel(name, ports, f"{prefix}_{channel}valid", f"{prefix}_{channel}ready")


def _packets(prefix: str, size: int) -> Channel:
    """Return an AXI4-Stream of so many bytes: TDATA, TKEEP, TLAST."""
    ports = ((f"{prefix}_tdata", 8 * size), (f"{prefix}_tkeep", size), (f"{prefix}_tlast", 1))
    return Channel(prefix.split("_")[-1], ports, f"{prefix}_tvalid", f"{prefix}_tready")


DESIGNS = (
    Design("paper"),
    Design("rgb24"),
    Design("plane"),
    Design("swift"),
    Design("paper", "axi"),
)
"""What is mutated."""


def wrapper(design: Design, select_bits: int) -> str:
    """Return a module ``bench`` around a design with the input ``mutsel``.

    Its ports have the same names for every design: a vector of all payloads in, each from a
    multiple of 32 bits on, and one of all payloads out.
    """
    pitch = 32 * design.payload_words
    links, assigns = [".mutsel(mutsel)"], []
    for side, channels in (("in", design.inputs), ("out", design.outputs)):
        for number, channel in enumerate(channels):
            lsb = pitch * number
            for port, width in channel.ports:
                links.append(f".{port}({side}_payload[{lsb} +: {width}])")
                lsb += width
            spare = pitch * (number + 1) - lsb
            if side == "out" and spare:
                assigns.append(f"assign out_payload[{lsb} +: {spare}] = 0;")
            outside = " && !rst" if channel.name == "poke" else ""
            links.append(f".{channel.valid}({side}_valid[{number}]{outside})")
            links.append(f".{channel.ready}({side}_ready[{number}])")
    if design.top == "engine":
        links += [".clk(clk)", ".rst(rst)", *([] if design.inside else [".in_frame(level)"])]
    else:
        links += [".aclk(clk)", ".aresetn(!rst)", ".irq(level)"]
        links += [f".s_axi_ctrl_{name}prot(3'd0)" for name in ("aw", "ar")]
    counts = {"in": len(design.inputs), "out": len(design.outputs)}
    return (
        "module bench(input clk, input rst, output level, output has_in_frame,\n"
        f"  input [{select_bits - 1}:0] mutsel,\n"
        f"  input [{pitch * counts['in'] - 1}:0] in_payload, input [31:0] in_valid,\n"
        f"  output [31:0] in_ready, output [{pitch * counts['out'] - 1}:0] out_payload,\n"
        "  output [31:0] out_valid, input [31:0] out_ready);\n"
        f"assign has_in_frame = {int(design.top == 'engine' and not design.inside)};\n"
        f"assign in_ready[31:{counts['in']}] = 0;\n"
        f"assign out_valid[31:{counts['out']}] = 0;\n"
        + "".join(f"{line}\n" for line in assigns)
        + f"splatline dut({', '.join(links)});\nendmodule\n"
    )
