import pytest

from splatline.cli.report import format_value, nonzero, print_facts, print_synthesis


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


def test_synthesis_stands_beside_the_paper_s_table(capsys):
    print_synthesis(
        {
            "preset": "paper",
            "command": "synth_xilinx",
            "lut4": 1999,
            "ff": 888,
            "bram": 17,
            "mult": 6,
            "paper": {"lut4": 2150, "ff": 960, "bram": 17},
            "device": {"name": "XC2V250", "lut4": 3072, "ff": 3072, "bram": 24, "mult": 24},
            "modules": {"splatline.decoder": {"lut4": 321, "ff": 45, "bram": 0, "mult": 0}},
        }
    )
    lines = capsys.readouterr().out.splitlines()
    luts = next(line for line in lines if "4-input LUTs" in line)
    assert [word for word in ("1,999", "65%", "2,150", "3,072") if word not in luts] == []
    mult = next(line for line in lines if line.strip("│ ").startswith("multipliers"))
    assert " - " in mult
    assert any("splatline.decoder" in line and "321" in line for line in lines)
