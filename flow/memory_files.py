"""Memories' initial contents: short in the Verilog, or in files of their own for ``$readmemh``."""

from __future__ import annotations

import re
import textwrap

__all__ = ["move_contents", "pack_contents"]

MEMORY = re.compile(
    r"^  reg \[(?P<high>\d+):0\] (?P<name>\w+) \[\d+:0\];\n"
    r"  initial begin\n"
    r"(?P<words>(?:(?: +(?P=name)\[\d+\] = \d+'h[0-9a-f]+;)+\n)+)"
    r"  end\n",
    re.MULTILINE,
)
"""A memory as Amaranth's Verilog has it, all of its words in order, or with several a line."""

WORD = re.compile(r"\[(\d+)\] = \d+'h([0-9a-f]+);")


COLUMNS = 100
"""Characters of a line with words of a memory."""


def pack_contents(text: str) -> str:
    """Return Verilog with the initial contents of its memories in few lines.

    Zeros are written in a loop, other words several a line.

    Parameters
    ----------
    text
        Verilog as Yosys writes it.
    """

    def pack(found: re.Match) -> str:
        name = found["name"]
        words = WORD.findall(found["words"])
        declared = found[0][: found[0].index("\n") + 1]
        if not any(int(value, 16) for _, value in words):
            width = int(found["high"]) + 1
            place = f"{name}_place"
            while re.search(rf"\b{place}\b", text):
                place += "_"
            return (
                f"{declared}  integer {place};\n"
                f"  initial for ({place} = 0; {place} < {len(words)}; {place} = {place} + 1)"
                f" {name}[{place}] = {width}'h{0:0{-(-width // 4)}x};\n"
            )
        lines = textwrap.wrap(
            " ".join(line.strip().replace(" ", "~") for line in found["words"].splitlines()),
            COLUMNS - 4,
        )
        packed = "".join(f"    {line}\n".replace("~", " ") for line in lines)
        return f"{declared}  initial begin\n{packed}  end\n"

    return MEMORY.sub(pack, text)


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
