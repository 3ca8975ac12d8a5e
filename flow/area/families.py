"""Resource counts of an engine in seven families of FPGAs, by Yosys.

Each family's lanes must be in block RAM. A memory that Yosys cannot put there becomes flip-flops,
or stops the synthesis.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from splatline.contract.config import EngineConfig
from splatline.flow.tools import ToolError, run_yosys
from splatline.flow.verilog import generate

__all__ = ["FAMILY_FLOWS", "KINDS", "FamilyFlow", "count_family", "count_memories", "lanes_of"]

NAME = "splatline"
"""Name of the top module."""

KINDS = ("lut", "ff", "bram", "mult")
"""Counted cells: LUTs, flip-flops, block RAMs and multipliers."""

LANE = re.compile(r"\blane_\d+_\d+\b")
"""Name of a lane in that of a cell."""

MEMORY_END = "map_ffram"
"""Label of Yosys' scripts behind the mapping of memories to block RAM and to LUTs."""


class FamilyFlow(NamedTuple):
    """A family: its synthesis command and its cells.

    Parameters
    ----------
    name
        The family.
    command
        Yosys' command.
    block_ram
        What a block RAM is, in words.
    cells
        By kind, patterns of whole names of cells, and how many each is.
    ignored
        Pattern of cells that are none of these: carries beside LUTs, buffers, constants.
    """

    name: str
    command: str
    block_ram: str
    cells: dict[str, dict[str, float]]
    ignored: str


FAMILY_FLOWS = {
    "xc2v": FamilyFlow(
        "Virtex-II",
        "synth_xilinx -family xc2v -ise -nowidelut -flatten",
        "18 kbit",
        {
            "lut": {"LUT[1-4]": 1, "RAM16X1S": 1, "RAM16X1D|RAM32X1S": 2, "RAM32X1D|RAM64X1S": 4},
            "ff": {"FD[RSCP]E(_1)?": 1},
            "bram": {r"RAMB16_S\d+(_S\d+)?": 1},
            "mult": {"MULT18X18S?": 1},
        },
        "MUXCY|XORCY|INV|[IO]BUF|BUFG|BUFGP|GND|VCC",
    ),
    "xc7": FamilyFlow(
        "7-series",
        "synth_xilinx -family xc7 -flatten",
        "18 kbit",
        {
            "lut": {"LUT[1-6]": 1, "RAM(32|64)M": 4, "RAM(32|64)X1D": 2, "RAM(32|64)X1S": 1},
            "ff": {"FD[RSCP]E(_1)?": 1},
            "bram": {"RAMB18E1": 1, "RAMB36E1": 2},
            "mult": {"DSP48E1": 1},
        },
        "CARRY4|MUXF[78]|INV|[IO]BUF|BUFG",
    ),
    "ecp5": FamilyFlow(
        "ECP5",
        "synth_ecp5",
        "18 kbit",
        {
            "lut": {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6},
            "ff": {"TRELLIS_FF": 1},
            "bram": {"DP16KD|PDPW16KD": 1},
            "mult": {"MULT18X18D": 1},
        },
        "PFUMX|L6MUX21|ALU54B",
    ),
    "nexus": FamilyFlow(
        "Nexus",
        "synth_nexus",
        "18 kbit",
        {
            "lut": {"LUT4": 1, "CCU2": 2, "WIDEFN9": 2, "DPR16X4": 6},
            "ff": {"FD1P3[BDIJ]X": 1},
            "bram": {"PDPSC16K|DP16K|PDP16K": 1},
            "mult": {"MULT(9X9|18X18|18X36|36X36)|MULTADDSUB18X18": 1},
        },
        "INV|VHI|VLO|[IO]B",
    ),
    "gowin": FamilyFlow(
        "Gowin",
        "synth_gowin",
        "18 kbit",
        {
            "lut": {"LUT[1-4]": 1, "ALU": 1, "RAM16SDP[124]": 6},
            "ff": {"DFF[A-Z]*": 1},
            "bram": {"(SDP|SP|DP|SDPX9|SPX9|DPX9)B?": 1},
            "mult": {"MULT(9X9|18X18|36X36)": 1},
        },
        "MUX2_LUT[5-8]|INV|GND|VCC|[IO]BUF|GSR",
    ),
    "ice40": FamilyFlow(
        "iCE40 UP5K",
        "synth_ice40 -device u -dsp",
        "4 kbit",
        {
            "lut": {"SB_LUT4": 1},
            "ff": {"SB_DFF[A-Z]*": 1},
            "bram": {"SB_RAM40_4K[A-Z]*": 1},
            "mult": {"SB_MAC16": 1},
        },
        "SB_CARRY",
    ),
    "cyclonev": FamilyFlow(
        "Cyclone V",
        "synth_intel_alm -family cyclonev",
        "10 kbit",
        {
            "lut": {"MISTRAL_ALUT[2-6]": 1, "MISTRAL_ALUT_ARITH": 1, "MISTRAL_MLAB": 1},
            "ff": {"MISTRAL_FF": 1},
            "bram": {"MISTRAL_M10K": 1},
            "mult": {r"MISTRAL_MUL(27X27|18X18|9X9)": 1},
        },
        "MISTRAL_NOT|MISTRAL_IO|MISTRAL_[IO]B|MISTRAL_CLKBUF",
    ),
}
"""By the name of a family on the command line."""


def count_family(config: EngineConfig, family: str) -> dict[str, int]:
    """Return what an engine takes in a family.

    Parameters
    ----------
    config
        The engine's configuration.
    family
        One of ``FAMILY_FLOWS``.

    Returns
    -------
    dict
        ``lut``, ``ff``, ``bram``, ``mult``. LUTs are those of the family, with four to six inputs;
        carries that take one and LUTs used as memory are among them.

    Raises
    ------
    ToolError
        If the memory of a lane is not in block RAM, if Yosys fails, or if it gives a cell that is
        not known.
    """
    flow = FAMILY_FLOWS[family]
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(generate(config, NAME)[0])
        lost = lanes_of(config) - {
            lane for lane, count in _map_memories(folder, family).items() if count
        }
        if lost:
            raise ToolError(
                f"{flow.name}: of {config.name} the memories of {len(lost)} lanes are not in"
                f" block RAM: {', '.join(sorted(lost)[:3])} ..."
            )
        run_yosys(
            f"read_verilog top.v; {flow.command} -top {NAME}; tee -o stat.json stat -json",
            folder,
        )
        cells = json.loads((folder / "stat.json").read_text())["modules"][f"\\{NAME}"]
    return _count(flow, cells["num_cells_by_type"])


def count_memories(text: str, family: str) -> Counter[str]:
    """Return the block RAMs of each lane in Verilog, whose top module is ``splatline``.

    They are those of a lane's name, as ``lane_0_3``, or of ``""`` for other memories. It runs Yosys
    as far as the mapping of memories.

    Raises
    ------
    ToolError
        If Yosys fails: for some families, if a memory that wants block RAM cannot have it.
    """
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(text)
        return _map_memories(folder, family)


def lanes_of(config: EngineConfig) -> set[str]:
    """Return the names of an engine's lanes."""
    rows, columns = range(config.tile_lines), range(config.pixels_per_word)
    return {f"lane_{row}_{column}" for row in rows for column in columns}


def _map_memories(folder: Path, family: str) -> Counter[str]:
    """Map the memories of ``top.v``; return the block RAMs by lane."""
    flow = FAMILY_FLOWS[family]
    run_yosys(
        f"read_verilog top.v; {flow.command} -top {NAME} -run :{MEMORY_END};"
        f" select {NAME}; write_json -selected mapped.json",
        folder,
    )
    found = json.loads((folder / "mapped.json").read_text())["modules"][NAME]["cells"]
    block_rams: Counter[str] = Counter()
    for name, cell in found.items():
        if _kind(flow, cell["type"])[0] == "bram":
            lane = LANE.search(name)
            block_rams[lane.group() if lane else ""] += 1
    return block_rams


def _kind(flow: FamilyFlow, cell: str) -> tuple[str, float]:
    """Return a cell's kind and how many it is; an empty kind if it is not known."""
    for kind, patterns in flow.cells.items():
        for pattern, each in patterns.items():
            if re.fullmatch(pattern, cell):
                return kind, each
    return "", 0


def _count(flow: FamilyFlow, cells: Mapping[str, int]) -> dict[str, int]:
    """Return the counts of each kind."""
    counts = dict.fromkeys(KINDS, 0.0)
    for cell, count in cells.items():
        name = cell.lstrip("\\")
        kind, each = _kind(flow, name)
        if kind:
            counts[kind] += each * count
        elif name != "$scopeinfo" and not re.fullmatch(flow.ignored, name):
            raise ToolError(f"{flow.name}: it is not known what the cell {name} takes")
    return {kind: int(count) for kind, count in counts.items()}
