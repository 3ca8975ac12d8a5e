import pytest

from splatline.cli.report.tables import format_value, nonzero, print_facts


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
