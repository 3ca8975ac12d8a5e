"""Sphinx's settings for the manual: ``make docs`` builds it in ``build/site``."""

import inspect
import re
import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for source_pages

project = "Splatline"
author = "the Splatline authors"
copyright = f"2026, {author}"
version = release = metadata.version("splatline")

extensions = [
    "myst_parser",  # the pages are Markdown
    "sphinx.ext.autodoc",  # the pages of api/ are made from docstrings
    "sphinx.ext.napoleon",  # which are in numpy's style
    "sphinx.ext.viewcode",  # and link to the source
    "sphinx_design",  # cards on the first page
    "source_pages",  # a link to a file of the repository shows the file
]
root_doc = "index"
exclude_patterns = ["**/*.py"]
highlight_language = "text"  # of a block that names none: commands and what they print
pygments_style = "tango"
pygments_dark_style = "monokai"

html_theme = "furo"
html_title = "Splatline"
html_static_path = ["_static"]
html_css_files = ["splatline.css"]
html_copy_source = html_show_sourcelink = False

myst_heading_anchors = 4  # links to headings, by GitHub's rule, are checked
myst_enable_extensions = ["colon_fence"]

autodoc_member_order = "bysource"
autodoc_preserve_defaults = True  # PAPER, and not all of its fields
autodoc_typehints = "none"  # docstrings give shapes and types of arrays, which types do not
python_maximum_signature_line_length = 88
napoleon_google_docstring = False
napoleon_custom_sections = [("Members", "params_style")]  # the ports of a component
napoleon_attr_annotations = False

# `make docs-links` asks for every address outside; it needs a network, so CI leaves it out.
linkcheck_timeout = 20
linkcheck_retries = 2

ROOT = Path(__file__).parents[1]
FROM_ROOT = {"contributing": "CONTRIBUTING.md", "changelog": "CHANGELOG.md"}
"""Pages that stand in the root of the repository, where GitHub looks for them."""


def read_source(app, docname, source):
    """Change what a page says before it is read.

    The decisions get a list of all their pages for the site's tree; GitHub would show it as text.
    A page that stands in the root is read from there, with its relative links moved.
    """
    if docname == "decisions/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n[0-9]*\n```\n"
    if docname in FROM_ROOT:
        path = ROOT / FROM_ROOT[docname]
        app.env.note_dependency(str(path))
        text = path.read_text(encoding="utf-8")
        text = re.sub(r"\]\((?!https?:|#)", "](../", text)
        source[0] = text.replace("](../docs/", "](")


def sign_component(app, what, name, obj, options, signature, returns):
    """Return the signature of a component's own ``__init__``; Amaranth hides it."""
    if what == "class" and (signature or "").startswith("(*args"):
        own = inspect.signature(obj.__init__)
        bare = [each.replace(annotation=each.empty) for each in own.parameters.values()]
        signature = str(own.replace(parameters=bare[1:], return_annotation=own.empty))
        return re.sub(
            r"EngineConfig\(name='(\w+)'[^)]*\)", lambda found: found[1].upper(), signature
        ), returns
    return None


def setup(app):
    """Connect what is above."""
    app.connect("source-read", read_source)
    app.connect("autodoc-process-signature", sign_component)
