"""Make the notebook ``tour.ipynb``: run its cells and store what they show.

Run it from the repository: ``.venv/bin/python docs/notebook/make_tour.py``.
"""

from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

TOUR = Path(__file__).with_name("tour.ipynb")

CELLS = (
    "# From a cloud to an engine's picture\n\n"
    "Splatline is hardware that draws point clouds. This notebook draws with its golden renderer,"
    " whose pictures are those of the Verilog, bit for bit.",
    "## A picture",
    "import splatline\n\n"
    'cloud = splatline.load_scene("terrain")  # or splatline.read_cloud("scan.laz")\n'
    "picture = splatline.render(cloud, size=(360, 240))\n"
    "picture",
    '`picture.save("scan.png")` writes it. `picture.rgb` is an array.',
    "picture.rgb.shape, picture.rgb.dtype",
    "## What is drawn, and what is not\n\n"
    "The host leaves out points that could not be seen. Each other one becomes code words.",
    "counts = picture.counts\n"
    "print(f\"{counts['points']:,} points, {counts['elements']:,} drawn\")\n"
    'for reason, points in counts["culled"].items():\n'
    '    print(f"{points:,} left out: {reason}")\n'
    "print(f\"{counts['codewords']:,} code words\")",
    "## What costs what\n\n"
    "More samples are more frames. Each preset is an engine: its LUTs, its block RAMs, its cycles.",
    "from splatline.view.hardware import picture_numbers\n\n"
    'print("preset   samples  code words   cycles  frames a second")\n'
    'for preset in ("paper", "rgb24", "swift"):\n'
    "    for samples in (1, 4):\n"
    "        made = splatline.render(cloud, size=(360, 240), preset=preset, samples=samples)\n"
    "        numbers = picture_numbers(made.drawing)\n"
    '        rate = numbers["fps"]\n'
    '        told = "clock not routed" if rate is None else f"{rate:,.0f}"\n'
    "        print(f\"{preset:8} {samples:7} {numbers['codewords']:11,} {numbers['cycles']:8,}"
    '  {told}")',
    "## Turn it\n\n"
    "Drag turns, shift and drag moves, the wheel zooms, `r` goes back. Each picture comes from the"
    " kernel; without one there is a still picture here.",
    "view = splatline.show(cloud, size=(360, 240), samples=4)\nview",
    "What is seen can be drawn again, and a film can be made of it:"
    ' `splatline.film(cloud, "turn.webp")`.',
    "same = splatline.render(cloud, size=(360, 240), camera=view.camera, samples=4)\n"
    "bool((same.rgb == view.picture.rgb).all())",
)
"""Texts begin with a heading or a sentence; the others are code."""

CODE = ("import ", "from ", "picture.rgb", "counts", "view =", "same =")


def tour() -> nbformat.NotebookNode:
    """Return the notebook, without outputs."""
    cells = []
    for number, text in enumerate(CELLS):
        new = new_code_cell if text.startswith(CODE) else new_markdown_cell
        cells.append(new(text, id=f"cell-{number}"))
    notebook = new_notebook(cells=cells)
    notebook.metadata["kernelspec"] = {
        "name": "python3", "display_name": "Python 3", "language": "python",
    }  # fmt: skip
    return notebook


def run(notebook: nbformat.NotebookNode, seconds: int = 300) -> nbformat.NotebookNode:
    """Run a notebook's cells; an error of a cell is raised."""
    client = NotebookClient(
        notebook, timeout=seconds, kernel_name="python3", store_widget_state=False,
        record_timing=False, coalesce_streams=True,
    )  # fmt: skip
    client.execute()
    notebook.metadata.pop("widgets", None)
    notebook.metadata.pop("language_info", None)
    return notebook


if __name__ == "__main__":
    nbformat.write(run(tour()), TOUR)
    print(f"{TOUR}: {TOUR.stat().st_size / 1000:.0f} kB")
