"""Every command line of the README and the manual is one that ``splatline`` or ``make`` takes."""

import re
import shlex
from pathlib import Path

import click
import pytest

from splatline.cli.main import main

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("**/*.md"))]
LINE = re.compile(r"^ {4,}(?:\S*bin/)?splatline +(\S.*?)(?: {2,}.*)?$", re.MULTILINE)
"""A command in a block of code, without what is said of it on the right."""

INLINE = re.compile(r"`splatline ([a-z][^`]*)`")

MAKE = re.compile(r"(?:^ {4,}|`)make ([a-z][^`\n]*?)(?:`| {2,}|$)", re.MULTILINE)
RULE = re.compile(r"^([a-z][\w-]*):.*\n((?:\t.*\n)*)", re.MULTILINE)
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")


def commands_of(page):
    """Return the command lines of a page, in blocks and within sentences."""
    text = page.read_text(encoding="utf-8")
    return [*LINE.findall(text), *(" ".join(words.split()) for words in INLINE.findall(text))]


def check(arguments, command=main, name="splatline"):
    """Parse arguments as click does; files need not exist, and ``NAME`` stands for a value."""
    context = click.Context(command, info_name=name)
    if isinstance(command, click.Group):
        if not arguments or arguments[0].startswith("-"):
            command.make_parser(context).parse_args(list(arguments))
            return
        found = command.get_command(context, arguments[0])
        assert found is not None, f"no command {arguments[0]}"
        check(arguments[1:], found, arguments[0])
        return
    values, _, given = command.make_parser(context).parse_args(list(arguments))
    for parameter in given:
        value = values[parameter.name]
        stands_for_one = isinstance(value, str) and value.isupper() and value.isalpha()
        is_file = isinstance(parameter.type, click.Path) or isinstance(parameter, click.Argument)
        if not is_file and not stands_for_one:
            parameter.type_cast_value(context, value)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_command_is_taken(page):
    for line in commands_of(page):
        try:
            check(shlex.split(line))
        except (click.ClickException, AssertionError) as error:
            pytest.fail(f"splatline {line}: {error}")


def check_make(arguments):
    """Check that the target is in the Makefile, and that its recipe uses the variables."""
    target, *variables = arguments
    rules = dict(RULE.findall(MAKEFILE))
    assert target in rules, f"no target {target}"
    for variable in variables:
        name = variable.partition("=")[0]
        assert f"$({name})" in rules[target], f"{target} does not use {name}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_target_of_make_is_there(page):
    for line in MAKE.findall(page.read_text(encoding="utf-8")):
        check_make(shlex.split(line))


@pytest.mark.parametrize("line", ["rendr", "lint PRESET=paper"])
def test_a_target_that_there_is_not_is_noticed(line):
    with pytest.raises(AssertionError):
        check_make(shlex.split(line))


def test_commands_are_found():
    assert len(MAKE.findall((ROOT / "README.md").read_text(encoding="utf-8"))) >= 5
    assert len(commands_of(ROOT / "README.md")) >= 10
    assert sum(len(commands_of(page)) for page in PAGES) > 100


@pytest.mark.parametrize(
    "line", ["rendr a.ply", "render --no-such a.ply", "render --engine fpga", "bench nothing"]
)
def test_a_command_that_there_is_not_is_noticed(line):
    with pytest.raises((click.ClickException, AssertionError)):
        check(shlex.split(line))
