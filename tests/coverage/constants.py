"""Bits of a design that no input can move, found by Yosys."""

import json
import re
import tempfile
from pathlib import Path

from splatline.flow.tools import run_yosys

__all__ = ["find_constants"]

SCRIPT = (
    "read_verilog top.v; hierarchy -top {top}; proc; flatten; opt_expr; opt_merge; opt_muxtree;"
    " opt_reduce; opt_dff; opt_clean; opt -full; techmap t:$lt t:$le t:$gt t:$ge; opt -full;"
    " write_json top.json"
)
"""Everything becomes one module, so that a constant reaches whatever depends on it alone.
Comparisons become gates: one of two bits with more than 3 is never true."""


def find_constants(text: str, top: str) -> dict[str, set[str]]:
    """Return the constant bits of a design by the place of their module.

    Parameters
    ----------
    text
        Verilog with all modules.
    top
        The top module's name.

    Returns
    -------
    dict
        By place, as of ``Module``: signals with their bits, such as ``data[3]``; ``valid`` where a
        signal has one bit. An instance whose name Verilog keeps for itself ends with ``_``.
    """
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(text)
        run_yosys(SCRIPT.format(top=top), folder)
        names = json.loads((folder / "top.json").read_text())["modules"][top]["netnames"]
    found: dict[str, set[str]] = {}
    for name, net in names.items():
        place, _, signal = name.rpartition(".")
        place = re.sub(r"_(?=\.|$)", "", place)
        low = net.get("offset", 0)
        one = len(net["bits"]) == 1 and "offset" not in net
        for number, bit in enumerate(net["bits"]):
            if isinstance(bit, str):
                found.setdefault(place, set()).add(signal if one else f"{signal}[{low + number}]")
    return found
