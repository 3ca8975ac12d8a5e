"""The animated drawings of the manual are what their scripts make today."""

import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

DOCS = Path(__file__).parents[2] / "docs"
MOST_BYTES = 300_000
PICTURE = re.compile(r'base64,[^"]+')
"""A PNG, whose bytes depend on the version of zlib."""


@pytest.mark.parametrize("name", ["window", "code_word"])
def test_a_drawing_is_made_anew(tmp_path, name):
    made = tmp_path / "made.svg"
    subprocess.run([sys.executable, DOCS / f"draw_{name}.py", made], check=True)
    kept = (DOCS / f"pictures/{name}.svg").read_text(encoding="utf-8")
    assert PICTURE.sub("", made.read_text(encoding="utf-8")) == PICTURE.sub("", kept)


@pytest.mark.parametrize("path", sorted(DOCS.glob("pictures/*.svg")), ids=lambda path: path.stem)
def test_a_drawing_is_small_and_loads_nothing(path):
    assert path.stat().st_size < MOST_BYTES
    root = ElementTree.parse(path).getroot()
    links = [value for node in root.iter() for key, value in node.items() if key.endswith("href")]
    assert all(link.startswith("data:image/png;") for link in links)
    assert "prefers-reduced-motion" in path.read_text(encoding="utf-8")
