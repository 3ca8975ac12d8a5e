"""The parts of the tiles engine, broken where they are written, and the bench of each."""

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.tiles import tiler
from splatline.rtl.tiles.dirty_bits import TileDirtyBits
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.lane import Lane
from splatline.rtl.tiles.tiler import Tiler
from splatline.rtl.tiles.window import TileWindow
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.front import test_colour
from tests.rtl.tiles import test_dirty_bits, test_flush_scan, test_lane, test_tiler, test_window
from tests.support.bench_config import run_bench
from tests.support.faults import rewrite

BENCHES = {
    Lane: (Lane, test_lane),
    Tiler: (Tiler, test_tiler),
    tiler: (Tiler, test_tiler),  # what it calls
    TileFlushScan: (TileFlushScan, test_flush_scan),
    TileDirtyBits: (TileDirtyBits, test_dirty_bits),
    ColourUnit: (test_colour.Painter, test_colour),
}


def check_rewritten(
    monkeypatch, part, pattern, replacement, test, method="elaborate", config=PAPER, **options
):
    """Break a component and run a test on it, or on the window that it is part of."""
    rewrite(monkeypatch, part, method, pattern, replacement)
    component, bench = BENCHES.get(part, (TileWindow, test_window))
    assert hasattr(bench, test)
    with pytest.raises(SimulationError):
        run_bench(config, component, bench.__file__, test=test, **options)
