"""Build of the player around the Verilog of an engine or a chain."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources

from splatline.contract.config import EngineConfig
from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import Build

__all__ = ["wrap"]

PLAYER = ("stream_source.v", "stream_sink.v", "stream_check.v", "frame_player.v")


def wrap(
    text: str,
    config: EngineConfig,
    engines: int | None = None,
    *,
    simulator_name: str = "verilator",
    progress: Callable[[float], None] | None = None,
) -> Build:
    """Build the player around Verilog, or return its cached build.

    Parameters
    ----------
    text
        Verilog of the engine or chain, possibly with a planted fault.
    config
        Configuration of the engine, or of the chain's engines.
    engines
        Number of engines of a chain; None: a single engine.
    simulator_name
        One of ``simulator.SIMULATORS``.
    progress
        Called now and then with the share of the build that is done.
    """
    names = ["codewords"] if engines is None else [f"codewords_{n}" for n in range(engines)]
    sources = {
        "splatline.v": _without_tools(text),
        "player_ports.v": _ports(config, names),
        **{name: resources.files(__package__).joinpath(name).read_text() for name in PLAYER},
    }
    parameters = {
        "ENGINES": len(names),
        "WORD_BITS": config.codeword_bits,
        "TABLE_BITS": config.table_address.end,
        "RASTER_BITS": config.raster_end.end,
    }
    return simulator.build(
        sources,
        "frame_player",
        simulator=simulator_name,
        parameters=parameters,
        progress=progress,
    )


def _without_tools(text: str) -> str:
    """Return Verilog without comment lines; these hold versions, which must not cause a rebuild."""
    return "\n".join(line for line in text.splitlines() if not line.startswith(("//", "/*")))


def _ports(config: EngineConfig, names: list[str]) -> str:
    """Return the module that connects the player's vectors to the ports of the engine or chain."""
    streams = {
        "tables": ("input", config.table_address.end),
        "initial": ("input", config.raster_end.end),
        "raster": ("output", config.raster_end.end),
    }
    count, word = len(names), config.codeword_bits
    ports = [
        "input clk, input rst",
        f"input [{word * count - 1}:0] codewords, input [{count - 1}:0] codewords_valid"
        f", output [{count - 1}:0] codewords_ready",
    ]
    links = [".clk(clk), .rst(rst)"]
    for name, (way, bits) in streams.items():
        back = "output" if way == "input" else "input"
        payload = "initial_beat" if name == "initial" else name  # a keyword of Verilog
        ports.append(f"{way} [{bits - 1}:0] {payload}, {way} {name}_valid, {back} {name}_ready")
        links.append(
            f".{name}__payload({payload}), .{name}__valid({name}_valid)"
            f", .{name}__ready({name}_ready)"
        )
    links += [
        f".{name}__payload(codewords[{word * n + word - 1}:{word * n}])"
        f", .{name}__valid(codewords_valid[{n}])"
        f", .{name}__ready(codewords_ready[{n}])"
        for n, name in enumerate(names)
    ]
    return (
        f"module player_ports({', '.join(ports)});\n"
        f"  splatline engine (\n    {f',{chr(10)}    '.join(links)});\nendmodule\n"
    )
