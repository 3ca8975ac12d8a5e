import click
import pytest

from splatline.cli.main import main
from splatline.cli.options.parameters import COLOUR, ORBIT, PRESET, SIZE, SPLAT_SIZE, UP_AXES
from splatline.contract.presets import DEFAULT, PAPER, PRESETS, REMOVED
from splatline.contract.variants import PLANE_VARIANTS, SHAPED, VARIANTS
from splatline.host.visibility.view import UP_AXES as KNOWN_AXES


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        (SIZE, "512x384", (512, 384)),
        (SIZE, " 1 X 1024 ", (1, 1024)),
        (ORBIT, "30,20", (30.0, 20.0)),
        (ORBIT, "-12.5, -90", (-12.5, -90.0)),
        (SPLAT_SIZE, "auto", None),
        (SPLAT_SIZE, "2.5e-3", 0.0025),
        (COLOUR, "#ff8000", (1.0, 128 / 255, 0.0)),
        (COLOUR, "000000", (0.0, 0.0, 0.0)),
        (COLOUR, "White", (1.0, 1.0, 1.0)),
        (PRESET, "paper", PAPER),
    ],
)
def test_what_is_written_is_understood(kind, text, value):
    assert kind.convert(text, None, None) == value


@pytest.mark.parametrize(
    ("kind", "value"),
    [(SIZE, (4, 3)), (ORBIT, (1.0, 2.0)), (SPLAT_SIZE, 0.5), (COLOUR, (0, 0, 0)), (PRESET, PAPER)],
)
def test_a_value_that_was_converted_stays(kind, value):
    # click may convert a default twice.
    assert kind.convert(value, None, None) == value


@pytest.mark.parametrize(
    ("kind", "text", "hint"),
    [
        (SIZE, "512", "like 512x512"),
        (SIZE, "512x", "like 512x512"),
        (SIZE, "-5x5", "like 512x512"),
        (SIZE, "5.5x5", "like 512x512"),
        (SIZE, "0x5", "at least 1"),
        (ORBIT, "30", "like 30,20"),
        (ORBIT, "30,20,10", "like 30,20"),
        (ORBIT, "30,,20", "like 30,20"),
        (ORBIT, "30,nan", "like 30,20"),
        (ORBIT, "inf,0", "like 30,20"),
        (ORBIT, "north,up", "like 30,20"),
        (SPLAT_SIZE, "big", "write auto"),
        (SPLAT_SIZE, "0", "above 0"),
        (SPLAT_SIZE, "-1", "above 0"),
        (SPLAT_SIZE, "nan", "write auto"),
        (COLOUR, "#fff", "#RRGGBB"),
        (COLOUR, "mauve", "#RRGGBB"),
        (PRESET, "huge", "'paper'"),
    ],
)
def test_what_is_not_understood_is_quoted_with_a_hint(kind, text, hint):
    with pytest.raises(click.BadParameter) as caught:
        kind.convert(text, None, None)
    assert repr(text) in caught.value.message
    assert hint in caught.value.message


def test_every_preset_has_its_name_here():
    assert {name: PRESET.convert(name, None, None) for name in PRESET.choices} == PRESETS | {
        config.name: config for config in (*SHAPED, *VARIANTS, *PLANE_VARIANTS)
    }


@pytest.mark.parametrize(("name", "instead"), REMOVED.items())
def test_a_removed_preset_says_what_to_take_instead(name, instead):
    with pytest.raises(click.BadParameter) as caught:
        PRESET.convert(name, None, None)
    assert caught.value.message == f"preset {name!r} was removed; take {instead}"


@pytest.mark.parametrize("command", ["render", "encode", "verilog", "synth", "pnr", "registers"])
def test_a_command_s_engine_is_the_default_preset(command):
    found = main.get_command(click.Context(main), command)
    (option,) = (each for each in found.params if each.name == "preset")
    context = click.Context(found)
    assert option.type_cast_value(context, option.get_default(context)) is DEFAULT


def test_the_up_axes_are_those_of_the_view():
    assert set(UP_AXES.choices) == set(KNOWN_AXES)
