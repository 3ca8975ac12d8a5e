"""A Sphinx extension: a link to a file of the repository leads to a page that shows the file.

The pages of the manual link to source files by relative paths, as GitHub wants them. Sphinx checks
that such a file exists and would offer it as a download. This extension makes a page of each.
"""

from __future__ import annotations

import html
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

SHOWN = {".json", ".py", ".toml", ".ucf", ".v"}
"""Ends of the names of files that become pages; any other file is downloaded."""

LARGEST = 200_000
"""Bytes of a file that becomes a page."""


def _root(app: Sphinx) -> Path:
    """Return the root of the repository."""
    return Path(app.srcdir).parent


def _page(app: Sphinx, name: str) -> str | None:
    """Return the page that shows a file, named relative to the manual; None if there is none."""
    path = (Path(app.srcdir) / name).resolve()
    inside = path.is_file() and path.is_relative_to(_root(app).resolve())
    if not inside or path.suffix not in SHOWN or path.stat().st_size > LARGEST:
        return None
    return f"source/{path.relative_to(_root(app).resolve()).as_posix()}"


def link_files(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Turn downloads of source files into links to their pages."""
    if app.builder.format != "html":
        return
    for node in list(doctree.findall(addnodes.download_reference)):
        name = Path(docname).parent / node["reftarget"]
        page = _page(app, node["reftarget"].lstrip("/")) or _page(app, name.as_posix())
        if page:
            link = app.builder.get_relative_uri(docname, page)
            node.replace_self(nodes.reference("", "", *node.children, internal=True, refuri=link))


def show_files(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Make a page of each source file that is linked to."""
    for name in list(app.env.dlfiles):
        page = _page(app, name)
        if page:
            text = (Path(app.srcdir) / name).read_text(encoding="utf-8")
            shown = app.builder.highlighter.highlight_block(text, _language(name))
            title = html.escape(page.removeprefix("source/"))
            del app.env.dlfiles[name]  # or it would be copied, to be downloaded
            yield page, {"title": title, "body": f"<h1>{title}</h1>\n{shown}"}, "page.html"


def _language(name: str) -> str:
    """Return the language of a file, by the end of its name."""
    return {".v": "verilog", ".ucf": "text"}.get(Path(name).suffix, Path(name).suffix[1:])


def setup(app: Sphinx) -> dict[str, bool]:
    """Install the extension."""
    app.connect("doctree-resolved", link_files)
    app.connect("html-collect-pages", show_files)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
