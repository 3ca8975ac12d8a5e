"""Initial contents of memories: in few lines of Verilog, or in files for ``$readmemh``."""

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
"""A memory in Yosys' Verilog, with one word a line or several."""

WORD = re.compile(r"\[(\d+)\] = \d+'h([0-9a-f]+);")


COLUMNS = 100
"""Length of a line with words of a memory."""


def pack_contents(text: str) -> str:
    """Return Verilog with the initial contents of its memories in few lines.

    Contents of zeros become a loop. Other contents have several words a line.

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
            # Most often it is nowhere, which is found out in no time.
            while place in text and re.search(rf"\b{place}\b", text):
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
    """Replace the initial contents of memories by ``$readmemh``, unless they are zeros.

    Simulators and synthesis tools read these files when they elaborate the Verilog, relative to the
    folder where they were started. The contents can then be changed without new Verilog.

    Parameters
    ----------
    text
        Verilog, as ``verilog.convert`` writes it.
    folder
        Path of the files' folder in the Verilog, with forward slashes.

    Returns
    -------
    text
        The Verilog without those contents.
    files
        The text of each file, by name: a word a line in hexadecimal.
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
