"""Compares a mutant in its window, which gets the inputs that an engine gives it, and no others.

Tiles come in a frame only, from ``active`` to the end token, and ``top`` is that of no tile
elsewhere. The size of the image, and whether there is an initial raster, change between frames.
``rtl.engine`` and ``rtl.tiles.tiler`` say so.
"""

import re
import tempfile
from pathlib import Path

from splatline.flow.tools import run_yosys
from splatline.rtl.tiles.layouts import TileLayout

from .cleared import window_of
from .keep import ROOT
from .mutate import Mutant, prepared
from .prove import PAIR, SEARCH, answer_of, run_abc
from .tops import Design
from .wrapper import ports_of, wrap

__all__ = ["may_hold_inputs", "prove_with_held_inputs"]

SECONDS = 400
"""Seconds of PDR."""

TOP = -4
"""``top`` before the first tile of a frame."""

HELD = re.compile(r"last_|load$")
"""Inputs that are held in a frame."""

FRAME = """\
reg opened = 0;
wire open = active | opened;
wire offered = {valid} & open;
always @(posedge clk) opened <= rst ? 0 : open & !(offered & {ready} & {payload}[{end}]);
wire idle = !open & !closing;
reg [{most}:0] tile;
always @* begin tile = {payload}; if (!open) tile[{top} +: {width}] = {TOP}; end
"""


def may_hold_inputs(design: Design, mutant: Mutant) -> bool:
    """Return whether a mutant is one of a window of tiles."""
    return bool(window_of(mutant)) and not design.config.draws_blocks


def prove_with_held_inputs(design: Design, mutant: Mutant) -> bool:
    """Return whether such a mutant is shown to be equal."""
    window, here = window_of(mutant), Path(__file__)
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="holding-") as scratch:
        folder = Path(scratch)
        il = prepared(design).read_text()
        (folder / "prepared.il").write_text(il)
        (folder / "whole.v").write_text(_whole(il, window, design))
        for name in ("memories.v", "memory_ports.v"):
            (folder / name).write_text(here.with_name(name).read_text())
        script = "read_rtlil prepared.il\ndesign -save base\n"
        for name in ("gold", "gate"):
            change = f"mutate {mutant.arguments()}\n" if name == "gate" else ""
            script += (
                f"design -load base\n{change}read_verilog whole.v\nhierarchy -top whole\nproc\n"
                "flatten\nopt_clean\nmemory_dff\nopt_clean\nread_verilog memory_ports.v\n"
                "techmap -map memories.v\nhierarchy -top whole\nexpose -evert c:*\nopt_clean\n"
                f"rename whole {name}\ndesign -stash {name}\n"
            )
        (folder / "both.ys").write_text(script + PAIR.format(name=0))
        run_yosys("script both.ys", folder)
        run_abc(folder, SEARCH.format(name=0, seconds=SECONDS))
        return answer_of(folder, 0) == "equal"


def _whole(il: str, window: str, design: Design) -> str:
    """Return a module around a window that holds its inputs as an engine does."""
    ports, layout = ports_of(il, window), TileLayout(design.config)
    fields = dict(layout)
    # The streams of tiles and of the initial raster have the same names, but for a number.
    (payload,) = (p.name for p in ports if p.size == layout.size and "payload" in p.name)
    (ready,) = (p.name for p in ports if p.name.startswith("i__ready") and p.way == "output")
    valid = payload.replace("payload", "valid")
    lines = [
        FRAME.format(
            payload=payload, valid=valid, ready=ready, end=fields["end"].offset,
            most=layout.size - 1, top=fields["top"].offset, width=fields["top"].width, TOP=TOP,
        )
    ]  # fmt: skip
    inside = {"active": "open", valid: "offered", payload: "tile"}
    for name, way, size in ports:
        if way == "input" and HELD.match(name):
            inside[name] = f"steady_{name}"
            lines += [
                f"reg [{size - 1}:0] kept_{name} = 0;",
                f"wire [{size - 1}:0] steady_{name} = idle ? {name} : kept_{name};",
                f"always @(posedge clk) kept_{name} <= steady_{name};",
            ]
    return wrap(window, ports, inside, lines, "w")
