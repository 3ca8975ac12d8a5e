"""The window of tiles: its lines never mix, and no pixel is lost or invented."""

from splatline.rtl.tiles.dirty_bits import TileDirtyBits
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.lane import Lane
from splatline.rtl.tiles.window import TileWindow
from splatline.rtl.window.frame_overlap import FrameOverlap
from splatline.rtl.window.loader import Loader
from tests.formal.prove import Fault, Proof
from tests.formal.window_properties import Narrow, TileWindowProperties

__all__ = ["PROOFS"]


TINY = Narrow(
    window_lines=8,
    pixels_per_word=2,
    x_bits=3,
    line_bits=4,
    depth_bits=2,
    channel_bits=1,
)
"""Four words of two pixels a line, eight lines in the window, an image of up to sixteen."""


SWEPT = Fault(
    "the sweep's last cycle", TileWindow, r"(sweep = Signal\(.*)\)", r"\1, init=-1)", "_clear"
)
"""The lanes have been cleared but for their last pixel."""


TINY_SIMPLE = TINY.with_memory("simple")
"""The same with memories of one port that writes and one that reads."""


TINY_PLANE = TINY.replace(plane=True)
"""The same with a depth in each lane."""


def plan(name, shows, load, depth, *faults, config=TINY, ordered=True, long=False):
    """Return a proof of the window."""
    return Proof(
        name=name,
        shows=shows,
        build=lambda: TileWindowProperties(config, load, ordered),
        depth=depth,
        engine="abc bmc3",
        changes=(SWEPT,),
        faults=faults,
        slow=True,
        long=long,
    )


PROOFS = [
    plan(
        "window of tiles",
        "a pixel leaves with its own line, as it was drawn, once; none is lost or invented",
        0,
        15,
        Fault("no conflict", TileWindow, r"\(drawn & tile\.meets\)", "(0)", "_arbitrate"),
        Fault(
            "a word leaves where a tile stood still",
            TileWindow,
            r"& ~\(stopped & drawn\)",
            "",
            "_arbitrate",
        ),
        Fault(
            "lanes not kept for a tile",
            TileWindow,
            r"& \(first \| ~\(offered & meeting\)\)",
            "",
            "_arbitrate",
        ),
        Fault("a line left too early", TileFlushScan, r"scans & moves & ", "scans & ", "_pairs"),
        Fault(
            "reached at the moment",
            TileFlushScan,
            r", now\) \| reach",
            ", now | reach)",
            "_reached",
        ),
        Fault("a turn ahead unnoticed", FrameOverlap, r"self\.wraps &", "0 &"),
        Fault("frames meet", FrameOverlap, r"turns\[1:\], self\.closing", "turns[1:], 0"),
        Fault("over too early", FrameOverlap, r"self\.clean \| self", "1 | self"),
        Fault("a frame closed twice", TileWindow, r" & ~flush_scan\.closing", "", "_connect_frame"),
        Fault("no depth test", Lane, r"en\.eq\(difference\[-1\]", "en.eq(taken.draw | taken.clear"),
    ),
    plan(
        "window of tiles, further",
        "the same, until every fault that is known of shows",
        0,
        18,
        Fault(
            "drawn while dirty bits are taken",
            TileWindow,
            r"swept & ~taking",
            "swept",
            "_arbitrate",
        ),
        Fault(
            "a tile goes where a word does", TileWindow, r"& ~\(first & meeting\)", "", "_arbitrate"
        ),
        long=True,
    ),
    plan(
        "window of tiles, initial raster",
        "the same for frames that start from an initial raster",
        1,
        14,
        Fault(
            "loaded beyond the window", Loader, r"waiting & ~drop & in_window", "waiting & ~drop"
        ),
        Fault(
            "a line left unloaded", TileFlushScan, r"self\.jump \| (\(self\.oldest < )", r"1 | \1"
        ),
        Fault("a line left while it is loaded", TileFlushScan, r"< self\.limit", "<= self.limit"),
        Fault(
            "limit a line too far", Loader, r"(limit\.eq\(Mux\(in_window, beat\.line)", r"\1 + 1"
        ),
        Fault("front a line too far", Loader, r"oldest, loaded\)", "oldest, loaded + 1)"),
        Fault("a line drawn into too early", Loader, r"\(config\.window_lines > BLOCK\)", "1"),
        Fault(
            "loaded where a word is cleared",
            TileWindow,
            r"& ~stopped(\s+& ~flush_scan\.taking)",
            r"\1",
            "_arbitrate",
        ),
        Fault(
            "loaded while dirty bits are taken",
            TileWindow,
            r"(& ~stopped\s+)& ~flush_scan\.taking",
            r"\1",
            "_arbitrate",
        ),
        Fault(
            "loaded in a tile's row",
            TileWindow,
            r"& ~\(offered & wanted\.bit_select\(loader.*\)\)",
            "",
            "_arbitrate",
        ),
        Fault(
            "a load marked in a tile's place",
            TileWindow,
            r"If\(flush_scan\.lone\[i\]\)",
            "If(0)",
            "_touch_loaded",
        ),
        Fault("a tile in a load's", TileWindow, r"lone\.eq\(.*\)", "lone.eq(-1)", "_touch_loaded"),
        Fault(
            "another pair marked",
            TileDirtyBits,
            r"load\[residue\] & \((other\[0\]) ==",
            r"load[residue] & (\1 !=",
        ),
    ),
    plan(
        "window of tiles, planes",
        "the same with a depth for each pixel",
        0,
        14,
        Fault("not cleared", TileWindow, r"depth\.eq\(~0\)", "depth.eq(given)", "_draw_depth"),
        Fault("another lane's depth", TileWindow, r"tile\.depth\[i\]\[j\]", "tile.depth[i][0]",
              "_connect_lanes"),
        config=TINY_PLANE,
    ),
    plan(
        "window of tiles, simple memories",
        "the same with an initial raster that takes the write port",
        1,
        14,
        Fault("loaded beside a tile", TileWindow, r"m\.If\(offered\)", "m.If(0)", "_arbitrate"),
        Fault("a tile's colour loaded", TileWindow, r"Mux\(offered, self\.shade, loaded\[j\]\)",
              "self.shade", "_draw"),
        Fault("a tile's depth loaded", TileWindow, r"Mux\(grants\.offered, given, .*\) if simple",
              "given if simple", "_connect_lanes"),
        Fault("background loaded", TileWindow, r"readout\.running, clears \| sweeping\)",
              "readout.running, written)", "_connect_lanes"),
        Fault("not loaded", TileWindow, r"sweeping \| loads if", "sweeping if", "_connect_lanes"),
        Fault("loaded while dirty bits are taken", TileWindow,
              r"(& ~stopped\s+)& ~flush_scan\.taking", r"\1", "_arbitrate"),
        config=TINY_SIMPLE,
    ),
]  # fmt: skip
