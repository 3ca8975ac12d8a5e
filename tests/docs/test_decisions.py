"""Each page of ``docs/decisions`` is one decision on one screen, and the table lists it."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DECISIONS = ROOT / "docs" / "decisions"
PAGES = sorted(DECISIONS.glob("[0-9]*.md"))

LINES, COLUMNS = 48, 120
SECTIONS = ["Context", "Measured", "Decision", "Consequence", "Tried, not kept"]
LAST = ["Not reached", "Next"]

ROW = re.compile(r"^\| \[(\d{4})\]\((.*?)\) \| (.*?) \| .* \|$", re.MULTILINE)
SECTION = re.compile(r"^\*\*(.+?)\*\*", re.MULTILINE)
LINK = re.compile(r"\]\((?!https?:)(.*?)\)")
NAMED = re.compile(r"`([\w.-]+/[^`\s]*)")
MADE = {"build"}


def faults(text, folder):
    """Return what the page's text does not keep, one line each."""
    prose = [line for line in text.splitlines() if not line.startswith("|")]
    found = []
    if len(text.splitlines()) > LINES:
        found.append(f"{len(text.splitlines())} lines of {LINES}")
    found += [f"too wide: {line}" for line in prose if len(line) > COLUMNS]
    sections = SECTION.findall(text)
    if sections[: len(SECTIONS) - 1] != SECTIONS[:-1]:
        found.append(f"begins with sections {sections}")
    rest = sections[len(SECTIONS) - 1 :]
    if rest != [name for name in [SECTIONS[-1], *LAST] if name in rest]:
        found.append(f"ends with sections {rest}")
    for link in LINK.findall(text):
        if not (folder / link.partition("#")[0]).exists():
            found.append(f"dead link: {link}")
    rooms = {path.name for path in ROOT.iterdir() if path.is_dir()} - MADE
    for name in NAMED.findall(text):
        if name.split("/")[0] in rooms and not (ROOT / name).exists():
            found.append(f"no such file: {name}")
    return found


def listed():
    rows = ROW.findall((DECISIONS / "README.md").read_text().replace(r"\|", "¦"))
    return [(number, page, title.replace("¦", "|")) for number, page, title in rows]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name[:4])
def test_a_page_is_one_screen_with_the_sections_of_the_readme(page):
    assert faults(page.read_text(), DECISIONS) == []


def test_the_table_has_each_page_once_with_its_title():
    titles = []
    for page in PAGES:
        heading = page.read_text().splitlines()[0]
        titles.append((page.name[:4], page.name, heading.removeprefix(f"# {page.name[:4]}. ")))
    assert sorted(listed()) == titles


def test_no_number_is_given_twice():
    numbers = [page.name[:4] for page in PAGES]
    assert len(set(numbers)) == len(numbers)


def test_the_readme_states_these_limits_and_sections():
    readme = (DECISIONS / "README.md").read_text()
    assert f"at most {LINES} lines" in readme
    assert f"at most {COLUMNS} columns" in readme
    assert SECTION.findall(readme) == [*SECTIONS, *LAST]


GOOD = "# 0001. A\n\n" + "\n\n".join(f"**{name}**\nA fact." for name in SECTIONS) + "\n"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (GOOD + "\n" * LINES, "lines of"),
        (GOOD + "a " * COLUMNS, "too wide"),
        (GOOD.replace("Context", "Measured"), "begins with"),
        (GOOD + "\n**Next**\n\n**Not reached**\n", "ends with"),
        (GOOD + "\n**Measured once**\n", "ends with"),
        (GOOD + "[a](0000-nothing.md)\n", "dead link"),
        (GOOD + "`host/nothing.py` does it.\n", "no such file"),
    ],
)
def test_faults_are_found(text, fault):
    assert faults(GOOD, DECISIONS) == []
    (found,) = faults(text, DECISIONS)
    assert fault in found


def test_tables_and_shell_lines_are_let_be():
    wide = f"| {'a' * COLUMNS} |\n`docs/measure_hidden.py /tmp/a.laz`, `build/site`, `a/b`\n"
    assert faults(GOOD + wide, DECISIONS) == []
