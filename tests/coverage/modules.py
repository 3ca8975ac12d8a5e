"""The modules of a Verilog text, each under a name that does not depend on the design's."""

import hashlib
import re
from dataclasses import dataclass

__all__ = ["Module", "find_modules"]


@dataclass(frozen=True)
class Module:
    """A module of a Verilog text.

    Parameters
    ----------
    name
        Its name in the text.
    place
        Its place in the design: the names of its instances down from the top, with dots between.
    first
        Its first line, from 1 on.
    digest
        Of its text, in which modules have the last part of their names. Two designs whose modules
        share a digest have the same hardware there, line by line.
    """

    name: str
    place: str
    first: int
    digest: str


def find_modules(text: str) -> list[Module]:
    """Return the modules of a text, in their order."""
    begins = list(re.finditer(r"(?m)^module (\w+)", text))
    names = [each[1] for each in begins]
    last_part = {name: name.rpartition("__")[2] for name in names}
    pattern = re.compile(r"\b(" + "|".join(map(re.escape, names)) + r")\b")
    modules = []
    for begin in begins:
        end = text.index("\nendmodule", begin.start())
        body = re.sub(r"^module \w+", "module", text[begin.start() : end])
        body = pattern.sub(lambda match: last_part[match[1]], body)
        name = begin[1]
        modules.append(
            Module(
                name,
                ".".join(name.split("__")[1:]),
                text.count("\n", 0, begin.start()) + 1,
                hashlib.sha256(body.encode()).hexdigest()[:16],
            )
        )
    return modules
