"""Points that no test reaches, and why."""

from dataclasses import dataclass

__all__ = ["EXCUSES", "Excuse"]


@dataclass(frozen=True)
class Excuse:
    """Why points are not reached.

    Parameters
    ----------
    points
        A pattern of whole points, as ``verilog`` names them.
    reason
        Why not.
    """

    points: str
    reason: str


COUNTERS = "frames|elements|cycles|input_stalls|output_stalls|words"

EXCUSES: list[Excuse] = [
    Excuse(
        r".*[ .](tiler toggle rest|flush_scan toggle behind)\[0\].*",
        "The lowest bit that is set is taken out of what is left, so the last bit is never left.",
    ),
    Excuse(
        r"plane .* branch line \d+: cond_(then|else)",
        "The last column of a word is never in the second word of a tile, so `next[3]`, which makes"
        " these choices, is always 0.",
    ),
    Excuse(
        r"swift engine tiler toggle (product_\d|turned_\w+|\w*)\[15\].*",
        "A row's eight bits are turned by a product with a number of one bit, so at most 7 places.",
    ),
    Excuse(
        r"swift engine window\.readout(\.queue(\.fifo)?)? toggle \w*(level(_2)?\[9\]|rdy|ready).*",
        "The queue never fills: no beat is requested once it is half full.",
    ),
    Excuse(
        r"swift engine window\.row_\* branch line \d+: cond_then",
        "The first column of a word in the image is in the image.",
    ),
    Excuse(
        rf"paper axi (\(top\)|registers) toggle (live|(live_)?({COUNTERS})(_value)?)\[\d+\].*",
        "The counters have 32 bits, and the frames of these tests are short. Those of"
        " `make faults TOP=axi` count further.",
    ),
    Excuse(
        r"paper axi .* toggle \w*r(ead_)?data(_2)?\[(15|16|29|31)\].*",
        "Bits of the read data that no register has but a counter, so high.",
    ),
    Excuse(
        r"paper axi registers(\.front)? toggle write_done:1->0",
        "A write of a table within a frame is refused, and between frames it is taken at once.",
    ),
    Excuse(
        r"paper axi engine(\.\w+)* toggle (frames\[1\]|limit(_2)?\[1[01]\]).*",
        "The AXI top opens a frame when the one before has ended. So none waits, and no initial"
        " raster meets a window that is still below the image.",
    ),
]
