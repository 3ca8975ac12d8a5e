"""Memories' initial contents in files of their own, for ``$readmemh``."""

from __future__ import annotations

import re

__all__ = ["move_contents"]

MEMORY = re.compile(
    r"^  reg \[(?P<high>\d+):0\] (?P<name>\w+) \[\d+:0\];\n"
    r"  initial begin\n"
    r"(?P<words>(?:    (?P=name)\[\d+\] = \d+'h[0-9a-f]+;\n)+)"
    r"  end\n",
    re.MULTILINE,
)
"""A memory as Amaranth's Verilog has it: all of its words in order, one a line."""

WORD = re.compile(r"\[(\d+)\] = \d+'h([0-9a-f]+);")


def move_contents(text: str, folder: str) -> tuple[str, dict[str, str]]:
    """Replace the contents of memories that start with more than zeros by ``$readmemh``.

    Simulators and the tools of FPGAs read such files when they elaborate the Verilog; they look for
    them from where they were started. The contents can then be changed without new Verilog.

    Parameters
    ----------
    text
        Verilog, as ``verilog.convert`` writes it.
    folder
        Where the files will lie, as the Verilog is to name it; slashes apart.

    Returns
    -------
    text
        The Verilog without those contents.
    files
        What to write into each file of the folder, by name: a word a line in hexadecimal.
    """
    files = {}

    def move(found: re.Match) -> str:
        words = WORD.findall(found["words"])
        if not any(int(value, 16) for _, value in words):
            return found[0]
        if [int(place) for place, _ in words] != list(range(len(words))):
            raise ValueError(f"the words of the memory {found['name']} are not in order")
        name = f"{found['name']}.hex"
        if name in files:
            raise ValueError(f"there are two memories named {found['name']}")
        files[name] = "".join(f"{value}\n" for _, value in words)
        declared = found[0][: found[0].index("\n") + 1]
        return declared + f'  initial $readmemh("{folder}/{name}", {found["name"]});\n'

    return MEMORY.sub(move, text), files
