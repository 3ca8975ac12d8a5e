"""Planted faults in the window of tiles, its loader and its readout: frames must show them."""

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.tiles.readout import TileReadout
from splatline.rtl.tiles.window import TileWindow
from splatline.rtl.window.loader import Loader
from tests.rtl.tiles import test_window
from tests.support.bench_config import PAIRED
from tests.support.planted import build, find_wrong

pytestmark = pytest.mark.planted

REWRITTEN = {
    "no conflict": (
        TileWindow,
        r"conflict\.eq\(\(drawn",
        "conflict.eq((0 & drawn",
        "with_stalls",
        "_arbitrate",
    ),
    "drawn while marks are taken": (
        TileWindow,
        r"~swept\s+& ~taking",
        "~swept",
        "with_stalls",
        "_arbitrate",
    ),
    "loaded while marks are taken": (
        TileWindow,
        r"~stopped\s+& ~flush_scan\.taking",
        "~stopped",
        "words_right_behind_what_leaves",
        "_arbitrate",
    ),
    "no wait after the sweep": (
        TileWindow,
        r"running\s+& ~swept",
        "running",
        "reset_in_the_middle",
        "_arbitrate",
    ),
    "a load offered again": (
        Loader,
        r" & ~\(self\.o\.valid & self\.o\.ready\)\)",
        ")",
        "with_stalls",
    ),
    "loaded beyond the window": (
        Loader,
        r"waiting & ~drop & in_window",
        "waiting & ~drop",
        "words_right_behind_what_leaves",
    ),
    "loaded into a tile's lanes": (
        TileWindow,
        r"& ~\(offered & wanted\.bit_select\(loader\.o\.payload\.line\[:2\], 1\)\)",
        "",
        "with_stalls",
        "_arbitrate",
    ),
    "a tile goes where a load goes first": (
        TileWindow,
        r"~tile\.end & ~pressing\)",
        "~tile.end)",
        "with_stalls",
        "_arbitrate",
    ),
    "marked in the line of a load that waits": (
        TileWindow,
        r"If\(flush_scan\.lone\[i\]\)",
        "If(service.serving & service.row[i])",
        "with_stalls",
        "_touch_loaded",
    ),
    "drawn before its lines have come": (
        Loader,
        r"self\.oldest, loaded\)\)",
        "self.oldest, loaded + 5))",
        "with_stalls",
    ),
    "said to have come too early": (
        Loader,
        r"limit\.eq\(Mux\(in_window, beat\.line,",
        "limit.eq(Mux(in_window, beat.line + 1,",
        "with_stalls",
    ),
    "background holds all up": (
        TileReadout,
        r" \| dropped\)",
        ")",
        "a_raster_that_waits_for_its_words",
    ),
    "dropped behind background": (TileReadout, r"(~emit\.end) & ~take\)", r"\1)", "with_stalls"),
    "a tile goes where a word does": (
        TileWindow,
        r"& ~\(first & meeting\)",
        "",
        "with_stalls",
        "_arbitrate",
    ),
    "lanes kept from what goes first": (
        TileWindow,
        r" & ~\(line & first\.replicate\(SIDE\)\)",
        "",
        "with_stalls",
        "_arbitrate",
    ),
    "lanes not kept for a tile": (
        TileWindow,
        r"& \(first \| ~\(offered & meeting\)\)",
        "",
        "with_stalls",
        "_arbitrate",
    ),
}
REWRITTEN_COLLISIONS = {
    "a load meets what is cleared": (
        TileWindow,
        r"~swept\s+& ~stopped\s",
        "~swept ",
        "words_right_behind_what_leaves",
        "_arbitrate",
    ),
    "a load meets what the sweep clears": (
        TileWindow,
        r"& ~swept\s+& ~stopped",
        "& ~stopped",
        "words_right_behind_the_sweep",
        "_arbitrate",
    ),
    "a tile meets one that stood still": (
        TileWindow,
        r" \| stopped\)",
        ")",
        "tiles_while_the_raster_waits",
        "_arbitrate",
    ),
    "a word leaves where a tile stood still": (
        TileWindow,
        r"& ~\(stopped & drawn\)",
        "",
        "a_line_that_leaves_behind_a_tile_that_stood_still",
        "_arbitrate",
    ),
}
REWRITTEN_PAIRS = {
    "even pixels keep their depth": (
        TileWindow,
        r"pixels\.depth\[j\] \| cleared",
        "pixels.depth[j]",
        "with_stalls",
        "_connect_pixels",
    ),
    "a pair right behind another": (
        TileWindow,
        r"m\.If\(readout\.busy\)",
        "m.If(0)",
        "with_stalls",
        "_arbitrate",
    ),
    "a tile where marks are taken": (
        TileWindow,
        r"taking = flush_scan\.taking & meeting",
        "taking = 0",
        "with_stalls",
        "_arbitrate",
    ),
    "the odd word in another's place": (TileReadout, r"m\.If\(flushed\)", "m.If(0)", "with_stalls"),
    "the end before an odd word": (
        TileReadout,
        r"self\.end & ~leaves",
        "self.end & ~flushed",
        "with_stalls",
    ),
    "an odd word lost while the raster waits": (
        TileReadout,
        r"~\(leaves & ~take\)",
        "~(flushed & ~take)",
        "with_stalls",
    ),
}


ENGINES = {
    "tiles": (PAPER, REWRITTEN, lambda text: text),
    "pairs": (PAIRED, REWRITTEN_PAIRS, lambda text: text),
    # Where the memory is as unkind as it may be.
    "collisions": (PAPER, REWRITTEN_COLLISIONS, test_window.collide),
}


@pytest.mark.parametrize("name", ENGINES)
def test_faults_in_the_window_are_noticed(name):
    """Those of a table in one build and one run, first without a fault."""
    config, table, edit = ENGINES[name]
    rows = [
        (part, *(method or ["elaborate"]), pattern, replacement)
        for part, pattern, replacement, _, *method in table.values()
    ]
    built = build(lambda: TileWindow(config), rows, edit)
    faults = {fault: (row[3], number) for number, (fault, row) in enumerate(table.items(), 1)}
    assert find_wrong(config, built, test_window, faults) == []
