"""The manual that ``make docs`` built has every page, and loads nothing from elsewhere."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SITE = ROOT / "build" / "site"
LOADED = re.compile(r'(?:src|srcset)="(?:https?:)?//|@import|url\(["\']?https?:')


@pytest.fixture
def site():
    assert SITE.is_dir(), "make docs builds the manual and runs these tests"
    return SITE


def test_every_page_is_in_the_site(site):
    for page in (ROOT / "docs").glob("**/*.md"):
        assert (site / page.relative_to(ROOT / "docs").with_suffix(".html")).is_file(), page


def test_a_link_to_a_source_file_shows_it(site):
    assert "source/contract/config.py.html" in (site / "contract.html").read_text()
    assert "EngineConfig" in (site / "source/contract/config.py.html").read_text()


def test_nothing_is_loaded_from_elsewhere(site):
    for page in site.glob("**/*.html"):
        assert not LOADED.search(page.read_text(encoding="utf-8")), page
    for style in site.glob("_static/**/*.css"):
        assert not LOADED.search(style.read_text(encoding="utf-8")), style


def test_dead_links_and_missing_names_are_errors(tmp_path):
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "conf.py").write_text("extensions = ['myst_parser', 'sphinx.ext.autodoc']\n")
    dead = ["[a](other.md)", "[a](#nowhere)", "[a](../file.py)"]
    dead.append("```{eval-rst}\n.. autofunction:: splatline.host.nothing\n```")
    (docs / "index.md").write_text("# Title\n\n" + "\n\n".join(dead) + "\n")
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q"]
    built = subprocess.run(
        [*command, docs, tmp_path / "site"], capture_output=True, text=True, check=False
    )
    assert built.returncode == 1
    for name in ("other.md", "nowhere", "file.py", "nothing"):
        assert name in built.stderr
