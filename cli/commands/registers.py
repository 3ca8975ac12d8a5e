"""``splatline registers``: the register map of an engine on AXI4-Lite."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.options.outputs import (
    check_files,
    check_folder,
    require_suffix,
    write_json,
    write_text,
)
from splatline.cli.options.parameters import PRESET
from splatline.contract.config import EngineConfig
from splatline.contract.presets import DEFAULT

__all__ = ["registers"]


@click.command()
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@click.option(
    "--c-header", "header", type=click.Path(path_type=Path), metavar="FILE", help="Write C99."
)
@click.option(
    "--c-driver",
    "driver",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Write a driver in freestanding C99, with its header.",
)
@click.option("--json", "data", type=click.Path(path_type=Path), metavar="FILE", help="Write JSON.")
@click.option(
    "--markdown", "page", type=click.Path(path_type=Path), metavar="FILE", help="Write the page."
)
def registers(
    preset: EngineConfig,
    header: Path | None,
    driver: Path | None,
    data: Path | None,
    page: Path | None,
) -> None:
    """Write the registers of an engine on AXI (verilog --top axi), or print them.

    A C header with offsets, masks and shifts, a JSON map and a page in Markdown are made from the
    same description as the hardware. Without an option, the page is printed.

    \b
    Examples:
      splatline registers
      splatline registers --preset rgb24 --c-header splatline.h
      splatline registers --preset rgb24 --c-driver firmware/
      splatline registers --json registers.json --markdown registers.md
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.contract.register_map import register_map
    from splatline.flow.register_texts import c_header, json_map, markdown
    from splatline.host.device.c import DRIVER

    for path, suffix in ((header, ".h"), (data, ".json"), (page, ".md")):
        require_suffix(path, suffix)
    check_files((header, data, page))
    if driver is not None:
        check_folder(driver)
        driver.mkdir(parents=True, exist_ok=True)
    described = register_map(preset)
    if header is not None:
        write_text(header, c_header(described))
    if data is not None:
        write_json(data, json_map(described))
    if page is not None:
        write_text(page, markdown(described))
    if driver is not None:
        write_text(driver / "splatline.h", c_header(described))
        for source in DRIVER:
            write_text(driver / source.name, source.read_text())
    written = [str(path) for path in (header, driver, data, page) if path is not None]
    if written:
        click.echo(f"{len(described.registers)} registers of {preset.name}: {', '.join(written)}")
    else:
        click.echo(markdown(described), nl=False)
