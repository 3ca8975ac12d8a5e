import pytest

from splatline.cli.report.tables import (
    colour_lines,
    format_range,
    format_value,
    nonzero,
    print_facts,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1234567, "1,234,567"),
        (1234.5678, "1,234.57"),
        (True, "True"),
        ({"facing_away": 1200, "outside": 3}, "facing away 1,200, outside 3"),
        ({}, "none"),
        ([1, 2.5], "1, 2.5"),
        ("terrain", "terrain"),
        (None, "None"),
    ],
)
def test_values_read_well(value, text):
    assert format_value(value) == text


def test_zeros_are_left_out_of_an_object_alone():
    assert nonzero({"outside": 0, "facing_away": 3}) == {"facing_away": 3}
    assert nonzero(0) == 0


def test_square_brackets_of_a_name_are_no_markup(capsys):
    print_facts([("written", "[red]scan[/red].png"), None, ("verdict", ("0", "green"))], title="t")
    printed = capsys.readouterr().out
    assert "[red]scan[/red].png" in printed
    assert "verdict" in printed


@pytest.mark.parametrize(
    ("ends", "right"),
    [
        ((0.0, 1.0), ("0", "1")),
        ((-0.5, 1234.5), ("-0.5", "1,234.5")),
        ((512000.25, 512200.75), ("512,000.25", "512,200.75")),
        ((1e9, 1e9 + 0.001), ("1,000,000,000", "1,000,000,000.001")),
        ((5.0, 5.0), ("5", "5")),
        ((-12345678, 12345678), ("-12,345,678", "12,345,678")),
    ],
)
def test_a_range_has_the_digits_that_tell_its_ends_apart(ends, right):
    assert format_range(*ends) == right


def test_many_classes_are_cut():
    classes = [{"class": i, "name": "", "colour": "#000000", "points": 1} for i in range(30)]
    key = {"by": "classification", "classes": classes, "other_classes": 4, "without_value": 2}
    lines = colour_lines(key)
    assert len(lines) == 1 + 24 + 2
    assert lines[-2:] == [("other classes", "10"), ("without a value", "2 points")]


def test_a_field_of_one_value_or_none_says_so():
    key = {"by": "time", "map": "viridis", "range": [3.0, 3.0], "without_value": 0}
    assert colour_lines(key) == [("coloured by", "time, 3 for every point")]
    assert colour_lines({**key, "range": None})[0][1] == "time, but no point has a value"
    assert colour_lines({}) == colour_lines(None) == []
