"""What is read from a router's report."""

import pytest

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards.build import clock_rates, unmet


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
