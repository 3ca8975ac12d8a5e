"""What is read from a router's report, and when there is a bitstream."""

import json
from types import SimpleNamespace

import pytest

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards import build
from splatline.boards.build import build_bitstream, clock_rates, unmet, untimed
from splatline.boards.catalog import BOARDS, make_system
from splatline.contract.presets import RGB24
from splatline.flow.timing.pnr import RESOURCES
from splatline.flow.tools import ToolError


def rate(achieved, constraint):
    return {"achieved": achieved, "constraint": constraint}


def test_clocks_have_the_names_of_their_domains_and_their_margin():
    report = {
        "fmax": {
            "$glbnet$ecp5pll0_clkout0": rate(75.0, 50.0),
            "$glbnet$hdmi_clk": rate(25.0, 25.0),
            "$glbnet$eth_clocks0_rx$TRELLIS_IO_IN": rate(100.0, 125.0),
        }
    }
    clocks = clock_rates(report, {"ecp5pll0_clkout0": "sys"})
    assert list(clocks) == ["sys", "hdmi", "eth_clocks0_rx"]
    assert clocks["sys"] == {"mhz": 75.0, "target_mhz": 50.0, "margin": 0.5}
    assert unmet(clocks) == "eth_clocks0_rx reaches 100.0 of 125.0 MHz"


def test_a_clock_that_is_missing_or_slower_than_it_must_be_is_named():
    clocks = clock_rates({"fmax": {"sys": rate(60.0, 49.975), "hdmi": rate(60.0, 12.0)}}, {})
    wanted = {"sys": 50e6, "hdmi": 25e6, "hdmi5x": 125e6}
    assert untimed(clocks, wanted) == "hdmi, hdmi5x"


@pytest.mark.parametrize("name", BOARDS)
def test_every_clock_of_a_board_is_one_that_must_be_met(name):
    system = make_system(name, RGB24)
    special = {"ulx3s": {"sys2x": 100e6}}.get(name, {"eth_clocks0_rx": 125e6})
    sys = 50e6 if name == "ulx3s" else 45e6
    assert system.crg.rates == {"sys": sys, "hdmi": 25e6, "hdmi5x": 125e6, **special}


@pytest.fixture
def tools(monkeypatch):
    """Put tools in place that take no time; the router reports what the returned dict has."""
    reported = {}

    def route(arguments, folder, progress):
        rows = {cell: {"used": 1, "available": 2} for cell in RESOURCES}
        report = {"fmax": reported, "utilization": rows}
        (folder / "report.json").write_text(json.dumps(report))

    def pack(arguments, folder):
        (folder / "top.bit").write_bytes(b"bits")

    monkeypatch.setattr(build, "system_files", lambda soc: {"board.v": ""})
    monkeypatch.setattr(build, "run_yosys", lambda script, folder, progress: None)
    monkeypatch.setattr(build, "run_nextpnr", route)
    monkeypatch.setattr(build, "run_ecppack", pack)
    return reported


SYSTEM = SimpleNamespace(
    platform=SimpleNamespace(device="LFE5U-25F-6BG381C"),
    crg=SimpleNamespace(names={}, rates={"sys": 50e6, "hdmi": 25e6}),
)


def test_a_bitstream_is_written_where_every_clock_is_met(tools, tmp_path):
    tools.update(sys=rate(51.0, 50.0), hdmi=rate(80.0, 25.0))
    told = build_bitstream(SYSTEM, RGB24, tmp_path / "a.bit")
    assert (tmp_path / "a.bit").read_bytes() == b"bits"
    assert told["clocks"]["sys"]["margin"] == 0.02


@pytest.mark.parametrize(
    ("clocks", "words"),
    [
        ({"sys": rate(49.0, 50.0), "hdmi": rate(80.0, 25.0)}, "sys reaches 49.0 of 50.0 MHz"),
        ({"sys": rate(51.0, 50.0)}, "no rate, or a lower one, for: hdmi"),
        ({"sys": rate(51.0, 12.0), "hdmi": rate(80.0, 25.0)}, "a lower one, for: sys"),
    ],
    ids=["missed", "missing", "unconstrained"],
)
def test_there_is_no_bitstream_otherwise(tools, tmp_path, clocks, words):
    tools.update(clocks)
    with pytest.raises(ToolError, match=words):
        build_bitstream(SYSTEM, RGB24, tmp_path / "a.bit")
    assert not list(tmp_path.iterdir())
