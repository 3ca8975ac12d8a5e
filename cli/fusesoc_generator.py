"""FuseSoC's generator of the hardware: ``splatline.core`` has it as ``splatline_verilog``.

FuseSoC runs this file with a YAML file of its own. It writes a core file and what that names into
the current folder. Parameters of a ``generate`` section, all optional:

- ``preset``: the engine's configuration, ``rgb24`` by default.
- ``top``: ``engine``, ``pins``, ``axi`` or ``framebuffer``, as of ``splatline verilog``.
- ``memory``: ``dual`` or ``simple``, as of ``splatline verilog``; the preset's own by default.
- ``name``: name of the top module; ``splatline`` by default.
- ``bench``: whether to write a test bench beside the engine; its module is ``bench``.
- ``ecp5_mhz``: clock rate of an ECP5, for a file of constraints for nextpnr.

Waivers for Verilator's lint come with the hardware. They are for files that Amaranth wrote.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml

__all__ = ["generate"]

WAIVERS = Path(__file__).parents[1] / "flow" / "verilator.vlt"

OPTIONS = ("preset", "top", "memory")
"""Parameters that are options of ``splatline verilog``."""

TYPES = {
    ".v": "verilogSource",
    ".vh": "verilogSource",
    ".vlt": "vlt",
    ".hex": "user",
    ".lpf": "LPF",
}


def generate(parameters: dict[str, Any], vlnv: str, folder: Path) -> Path:
    """Write the hardware and a core file that names it.

    Parameters
    ----------
    parameters
        Those of a ``generate`` section.
    vlnv
        The core's name, as FuseSoC gives it.
    folder
        Where the files go.

    Returns
    -------
    pathlib.Path
        The core file.

    Raises
    ------
    subprocess.CalledProcessError
        If ``splatline verilog`` refuses the parameters; it says why.
    """
    name = parameters.get("name", "splatline")
    options = ["-o", f"{name}.v", "--name", name]
    options += [f"--{each}={parameters[each]}" for each in OPTIONS if each in parameters]
    if parameters.get("bench"):
        options += ["--bench", "."]
    program = "from splatline.cli.main import main; main()"
    subprocess.run([sys.executable, "-c", program, "verilog", *options], cwd=folder, check=True)
    shutil.copyfile(WAIVERS, folder / f"{name}.vlt")
    if "ecp5_mhz" in parameters:
        _write_limits(folder, name, parameters)
    files = [_entry(path) for path in sorted(folder.iterdir()) if path.suffix in TYPES]
    core = {
        "name": vlnv,
        "filesets": {"hardware": {"files": files}},
        "targets": {"default": {"filesets": ["hardware"]}},
    }
    path = folder / f"{name}.core"
    path.write_text("CAPI=2:\n" + yaml.safe_dump(core, sort_keys=False))
    return path


def _entry(path: Path) -> dict[str, dict[str, Any]]:
    """Return a file's entry in a core file; the bench reads its numbers from where it runs."""
    entry: dict[str, Any] = {"file_type": TYPES[path.suffix]}
    if path.suffix == ".vh":
        entry["is_include_file"] = True
    if path.suffix == ".hex":
        entry["copyto"] = path.name
    return {path.name: entry}


def _write_limits(folder: Path, name: str, parameters: dict[str, Any]) -> None:
    """Write nextpnr's constraints: the clock's rate, and the kind of pins if there are pins."""
    limits = ""
    clock = "aclk" if parameters.get("top") in ("axi", "framebuffer") else "clk"
    if parameters.get("top") == "pins":
        from splatline.flow.timing.pnr import CONSTRAINTS

        limits = CONSTRAINTS.read_text()
    # The last of two frequencies of a clock counts.
    limits += f'FREQUENCY PORT "{clock}" {parameters["ecp5_mhz"]:g} MHZ;\n'
    (folder / f"{name}.lpf").write_text(limits)


if __name__ == "__main__":
    asked = yaml.safe_load(Path(sys.argv[1]).read_text())
    generate(asked["parameters"] or {}, asked["vlnv"], Path.cwd())
