"""``splatline board``: bitstreams of whole systems, and pictures on the screen of a board."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from splatline.boards.catalog import BAUD, BOARDS
from splatline.cli.options.drawing import background_option
from splatline.cli.options.outputs import check_files, require_suffix, write_json
from splatline.cli.options.parameters import PRESET
from splatline.cli.report.progress import Stages
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.presets import DEFAULT

__all__ = ["board"]

_FILE = click.Path(path_type=Path)
_BOARD = click.Choice(list(BOARDS))


@click.group()
def board() -> None:
    """Put the engine on a board that one can buy. No board has run this yet (docs/boards.md).

    \b
    Examples:
      splatline board build ulx3s
      splatline board load splatline_ulx3s_rgb24.bit
      splatline board play knot_*.frame --port /dev/ttyUSB0
    """  # noqa: D301


@board.command()
@click.argument("name", metavar="BOARD", type=_BOARD)
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@click.option("--seed", type=click.IntRange(0), default=1, help="Seed of the placer.")
@click.option(
    "--cpu", type=click.Choice(["serv", "vexriscv"]), show_default="none",
    help="A processor on the bus, for programs of your own. Nothing here needs one.",
)  # fmt: skip
@click.option(
    "--program", type=_FILE, metavar="FILE", show_default="a jump to itself",
    help="Its program: the contents of the ROM from address 0 on, at most 8 KiB.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=_FILE, metavar="FILE", show_default="splatline_BOARD_PRESET.bit",
    help="The bitstream; its description is written beside it (.json).",
)  # fmt: skip
def build(
    name: str,
    preset: EngineConfig,
    seed: int,
    cpu: str | None,
    program: Path | None,
    output: Path | None,
) -> None:
    """Make the bitstream of a board: ulx3s, colorlight-i5 or colorlight-i9.

    It takes some minutes. If a clock is not met, there is no bitstream.

    \b
    Examples:
      splatline board build ulx3s
      splatline board build colorlight-i5 --preset paper --seed 2
      splatline board build ulx3s --cpu serv --program hello.bin
    """  # noqa: D301
    from splatline.boards.catalog import make_system

    if output is None:
        output = Path(f"splatline_{name}_{preset.name}.bit")
    require_suffix(output, ".bit")
    beside = output.with_suffix(".json")
    check_files((output, beside))
    import logging

    logging.disable(logging.WARNING)  # LiteX tells all that it does
    with Stages().stage("", f"Building {preset.name} for {name}") as share:
        system = make_system(name, preset, cpu, **_program(cpu, program))
        from splatline.boards.build import build_bitstream
        from splatline.boards.describe import describe

        result = build_bitstream(system, preset, output, seed=seed, progress=share)
        write_json(beside, describe(system, board=name, link=BOARDS[name].link, **result))
    _print(name, preset, result, output)


@board.command()
@click.argument("bitstream", type=_FILE)
def load(bitstream: Path) -> None:
    """Load a bitstream of ``board build`` into its board, with openFPGALoader.

    \b
    Examples:
      splatline board load splatline_ulx3s_rgb24.bit
    """  # noqa: D301
    from splatline.boards.load import load_bitstream

    told = read_system(bitstream.with_suffix(".json"))
    load_bitstream(told["board"], bitstream)
    click.echo(f"{bitstream} runs on the board")


@board.command()
@click.argument("frames", nargs=-1, required=True, type=_FILE)
@click.option(
    "--port", required=True, help="Serial port or IP address, such as /dev/ttyUSB0 or 192.168.1.50."
)
@click.option(
    "--system", type=_FILE, metavar="FILE", show_default="the only one in this folder that fits",
    help="Description beside the bitstream (.json).",
)  # fmt: skip
@click.option(
    "--hold", type=click.IntRange(0, 255), default=0,
    help="Refreshes of the screen that pass between two pictures: 0 is 60 pictures a second.",
)  # fmt: skip
@click.option("--once", is_flag=True, help="Stop at the last frame.")
@background_option
def play(
    frames: tuple[Path, ...],
    port: str,
    system: Path | None,
    hold: int,
    once: bool,
    background: tuple[float, float, float] | None,
) -> None:
    """Send frames of ``splatline encode`` to a board, and play them on its screen.

    They must have one size and the same tables: one cloud from several sides.

    \b
    Examples:
      splatline board play knot_*.frame --port /dev/ttyUSB0
      splatline board play knot_*.frame --port 192.168.1.50 --hold 2
    """  # noqa: D301
    from splatline.boards.board import Board
    from splatline.host.frame_file import load_frame
    from splatline.plots.figure import BACKGROUND

    loaded = [load_frame(path) for path in frames]
    told = read_system(_only_system(loaded[0].config.name) if system is None else system)
    link = _open(port, told)
    stages = Stages()
    driver = Board(link, told)
    red, green, blue = (round(255 * level) for level in background or BACKGROUND)
    with stages.stage("start", "Starting the board's memory"):
        driver.start()
    with stages.stage("upload", f"Sending {len(loaded)} frames") as share:
        driver.upload(loaded, (red, green, blue), share)
    driver.play(loop=not once, hold=hold)
    size = sum(frame.codewords.nbytes for frame in loaded)
    click.echo(
        f"{len(loaded)} frames, {size:,} bytes, sent in {stages.seconds['upload']:.1f} s;"
        " the board plays them"
    )


def _program(cpu: str | None, path: Path | None) -> dict[str, bytes]:
    """Return a processor's program, as an option of a system; none if it is not given."""
    if path is None:
        return {}
    if cpu is None:
        raise InputError("--program needs --cpu")
    from splatline.boards.processor import ROM_BYTES

    try:
        program = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from None
    if not 0 < len(program) <= ROM_BYTES:
        raise InputError(f"{path} has {len(program)} bytes, and the ROM has {ROM_BYTES}")
    return {"program": program}


def read_system(path: Path) -> dict[str, Any]:
    """Return the description of a system.

    Raises
    ------
    InputError
        If there is none, or it is something else.
    """
    try:
        told = json.loads(path.read_text())
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from None
    except ValueError:
        raise InputError(f"{path} is not valid JSON; build the board again") from None
    if not isinstance(told, dict) or told.get("board") not in BOARDS:
        raise InputError(f"{path} does not describe a board's system; build the board again")
    return told


def _only_system(preset: str) -> Path:
    """Return the description of a system with a preset in this folder."""
    names = [Path(f"splatline_{name}_{preset}.json") for name in BOARDS]
    found = [path for path in names if path.is_file()]
    if len(found) != 1:
        what = ", ".join(map(str, found)) if found else "none"
        raise InputError(
            f"--system must name the description beside the bitstream of a board with preset"
            f" {preset}; in this folder there is {what}"
        )
    return found[0]


def _open(port: str, told: dict[str, Any]) -> Any:
    """Return the link to a board."""
    if told["link"] == "etherbone":
        from splatline.boards.etherbone_link import EtherboneLink

        return EtherboneLink(port, scratch=told["registers"]["ctrl_scratch"])
    from splatline.boards.uart_link import open_serial

    return open_serial(port, BAUD)


def _print(name: str, preset: EngineConfig, result: dict[str, Any], output: Path) -> None:
    """Print the clocks and the utilisation."""
    from splatline.cli.report.tables import print_facts

    facts: list[Any] = [
        (
            f"clock {domain}",
            f"{rate['mhz']:.1f} MHz, {rate['margin']:.0%} above {rate['target_mhz']:g} MHz",
        )
        for domain, rate in result["clocks"].items()
    ]
    facts += [
        None,
        *(
            (
                label,
                f"{use['used']:,} of {use['available']:,} ({use['used'] / use['available']:.0%})",
            )
            for label, use in result["utilisation"].items()
        ),
        None,
        ("written", str(output)),
        ("written", str(output.with_suffix(".json"))),
    ]
    print_facts(facts, title=f"{preset.name} on {name} ({result['device']})")
