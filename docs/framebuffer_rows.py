"""Simulates the frame buffer top: two frames, the memory and the display."""

from functools import cache

from bus_rows import packet, register_feeds
from port_traces import axi_feed, trace
from port_words import CLEARED, CONFIG, LINES, elements

from splatline.rtl.framebuffer.top import FrameBufferTop

__all__ = ["BUFFERS", "BURST", "STRIDE", "framebuffer_rows"]

BUFFERS = 0x2000, 0x3000
STRIDE = 0x40
BACKGROUND = 0x1F1A17
SLVERR = 2
BURST = 8
"""Bus words of a line: two pixels each."""

WAITS = 30
"""Cycles with ``swap_valid``."""


class Memory:
    """A memory on AXI4 that waits now and then, and answers 2 cycles after a burst's last word.

    The burst of number ``wrong`` is answered by SLVERR.
    """

    def __init__(self, top, wrong):
        self.wires = {
            name: getattr(top, f"m_axi_{name}")
            for name in (
                "awvalid", "awready", "awaddr", "awlen", "wvalid", "wready", "wlast", "bvalid",
                "bready", "bresp",
            )
        }  # fmt: skip
        self.wrong = wrong
        self.cycle, self.beats, self.bursts, self.answered = 0, 0, 0, 0
        self.written = []  # cycles in which a burst's last word is taken

    def drive(self, ctx, rows):
        """Be ready or not, and answer."""
        self.cycle = cycle = len(rows)
        due = self.written[self.answered : self.answered + 1]
        answers = bool(due) and due[0] + 2 <= cycle and self.bursts > self.answered
        ctx.set(self.wires["awready"], int(cycle % 4 == 0))
        ctx.set(self.wires["wready"], int(cycle % 8 != 3))
        ctx.set(self.wires["bvalid"], int(answers))
        ctx.set(self.wires["bresp"], SLVERR if answers and self.answered == self.wrong else 0)

    def record(self, ctx):
        """Return the labels of what is on the channels; of data the number of the beat."""
        now = {name: ctx.get(wire) for name, wire in self.wires.items()}
        took = {name: now[f"{name}valid"] & now[f"{name}ready"] for name in ("aw", "w", "b")}
        labels = {
            "awaddr": f"{now['awaddr']:x}",
            "awlen": str(now["awlen"]),
            "w": str(self.beats),
            "bresp": str(now["bresp"]),
        }
        self.bursts += took["aw"]
        self.answered += took["b"]
        if took["w"]:
            self.beats = 0 if now["wlast"] else self.beats + 1
            self.written += [self.cycle] if now["wlast"] else []
        row = {}
        for wire, label in labels.items():
            channel = "aw" if wire.startswith("aw") else wire[0]
            row[f"m_axi_{wire}"] = label if now[f"{channel}valid"] else None
            row[f"m_axi_{wire}.taken"] = took[channel]
        return row


class Display:
    """The wires beside the bus: settings, and the swap some cycles after a picture is whole.

    The settings are there from the cycle on in which a frame's first code word is offered, up to
    its ``swap_valid``. In all other cycles they are 0.
    """

    def __init__(self, top):
        self.top = top
        self.frame, self.held, self.whole = 0, False, 0

    def drive(self, ctx, rows):
        """Set the settings, and ``swapped``."""
        top = self.top
        before, self.whole = self.whole, self.whole + 1 if ctx.get(top.swap_valid) else 0
        if before == 0 and self.whole == 1:
            self.held = False
        elif ctx.get(top.s_axis_codewords_tvalid) and not self.held:
            self.held = True
            self.frame += 1
        values = (*BUFFERS, STRIDE, BACKGROUND) if self.held else (0,) * 4
        names = ("buffer_0", "buffer_1", "stride", "background")
        for name, value in zip(names, values, strict=True):
            ctx.set(getattr(top, name), value)
        ctx.set(top.swapped, int(self.whole == WAITS))

    def record(self, ctx):
        """Return whose settings these are."""
        return {"settings": f"frame {self.frame}" if self.held else None}


@cache
def framebuffer_rows():
    """Return two frames on the frame buffer top; the second one's first burst has an error.

    The second frame's code words come while the first picture waits to be shown.
    """
    top = FrameBufferTop(CONFIG)
    writer = top.writer
    values = {"LAST_COLUMN": 2 * BURST - 1, "LAST_LINE": LINES - 1, "IRQ_ENABLE": 1}
    parts = [
        *register_feeds(top, values),
        axi_feed(top, "s_axis_codewords", packet(elements(0)) * 2, when=_offered),
        Memory(top, wrong=LINES),
        Display(top),
    ]  # fmt: skip
    watch = {name: getattr(top, name) for name in (
        "s_axis_codewords_tvalid", "s_axis_codewords_tready", "m_axi_awvalid", "m_axi_awready",
        "m_axi_wvalid", "m_axi_wready", "m_axi_wlast", "m_axi_bvalid", "m_axi_bready",
        "swap_valid", "swap_index", "swapped", "irq", "writer_error")}  # fmt: skip
    within = {
        "beat": writer.beats.valid & writer.beats.ready,
        "word": writer.writer.words.valid & writer.writer.words.ready,
    }
    return trace(
        top, parts, watch | within, CONFIG.clear_cycles + 370, clock=top.aclk, reset=top.aresetn
    )


def _offered(rows):
    """Return whether a code word is offered next: the second frame once a picture waits."""
    first = len(elements(0))
    if sum(row["s_axis_codewords.taken"] for row in rows) < first:
        return len(rows) >= CLEARED
    return any(row["swap_valid"] for row in rows[:-3])
