"""Mutants that survive since they change no result, and why."""

__all__ = ["EQUAL"]

EQUAL: dict[tuple[str, str], str] = {
    ("sim/golden/kernel.py", "if y + BELOW is not end:"): (
        "Lines below a band's last are opened too. None of them is closed, so none is drawn."
    ),
    (
        "sim/golden/kernel.py",
        "shape, raised, shifted = _middle(word) if symmetric else (word, 0, 1)",
    ): "A shape is shifted where it is symmetric.",
    ("host/encode/plane_loop.py", "found, x, top, scans = 2, -1, 0, 0"): (
        "Who finds 2 does not look at the place."
    ),
    (
        "host/visibility/cull.py",
        "return math.ceil(centre * reach - ROUNDING - 0.5) > math.floor(centre + reach + ROUNDING"
        " - 0.5)",
    ): "Fewer blocks are skipped, as the reach is below half a pixel, or those left of the image.",
    ("host/files/read_text.py", "if head[first::2].count(0) >= zeros > 0.45 * len(head):"): (
        "Half of the bytes have no more zeros than all of them."
    ),
    ("host/files/read_e57.py", "rows = _stack(table, places, 1)"): (
        "The number counts where a coordinate is missing; such a scan was refused before."
    ),
    (
        "host/files/read_e57.py",
        "plain = dict(zip((*places, *NORMALS, *COLOURS), PLAIN, strict=False))",
    ): "There are as many names as plain ones.",
}
"""Reasons by file and changed line, without spaces about it."""
