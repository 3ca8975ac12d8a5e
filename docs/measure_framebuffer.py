"""Measure the frame writer: cycles and bytes of a frame, LUTs and flip-flops.

Run as ``.venv/bin/python docs/measure_framebuffer.py``. The built-in scenes, 512 x 512, drawn by
golden, are given to the writer four times, a beat in every cycle in which it takes one. The memory
takes a word in every cycle and answers two cycles after a burst's last word. The first two frames
write every line, and the others skip what is background already. Verilator runs it. Then Yosys
counts the writer alone, for an XC2V250 and for an ECP5.
"""

import json
import os
import tempfile
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

from splatline.contract.presets import PAPER, PLANE, RGB24, SWIFT
from splatline.contract.raster_beats import to_beats
from splatline.flow.area.synth import count_component
from splatline.flow.tools import run_yosys
from splatline.flow.verilog import convert
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.scenes.scenes import SCENES
from splatline.rtl.framebuffer.frame_writer import FrameWriter
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cycles.cycles import count_cycles

SIZE = 512
FRAMES = 4
WIDTHS = (32, 64, 128)
COUNTED = ((PAPER, 32), (RGB24, 32), (RGB24, 64), (RGB24, 128), (PLANE, 64), (SWIFT, 128))

PLAYER = """
module player(input clk, input rst, output swap_valid, output reg [31:0] cycles,
              output reg [31:0] words, output reg [31:0] bursts);
  reg [BITS-1:0] beats [0:COUNT-1];
  reg [8*256-1:0] file;
  initial if ($value$plusargs("beats=%s", file)) $readmemh(file, beats);
  reg [31:0] place;
  reg answer, last, started;
  wire ready, aw, w, wl;
  wire [LANES-1:0] strobes;
  wire end_beat = place == COUNT - 1;
  writer writer(
    .clk(clk), .rst(rst), .beats__payload(beats[place]), .beats__valid(1'b1),
    .beats__ready(ready), .buffer_0(32'h0), .buffer_1(32'h100000), .stride(16'd2048),
    .last_column(9'd511), .last_line(10'd511), .background(24'h1f1a17),
    .swap_valid(swap_valid), .swapped(swap_valid), .m_axi__awready(1'b1), .m_axi__awvalid(aw),
    .m_axi__wready(1'b1), .m_axi__wvalid(w), .m_axi__wlast(wl), .m_axi__wstrb(strobes),
    .m_axi__bid(1'b0), .m_axi__bresp(2'b0), .m_axi__bvalid(answer));
  always @(posedge clk) begin
    last <= w & wl;
    answer <= last;
    if (rst) begin
      place <= 0; cycles <= 0; words <= 0; bursts <= 0; started <= 0; answer <= 0; last <= 0;
    end else begin
      if (ready) place <= end_beat ? 0 : place + 1;
      started <= swap_valid ? 0 : started | ready;
      cycles <= swap_valid ? 0 : cycles + (started | ready);
      words <= swap_valid ? 0 : words + w;
      bursts <= swap_valid ? 0 : bursts + aw;
    end
  end
endmodule
"""
"""Gives the beats of a file again and again, and is a memory that never waits."""


@cocotb.test()
async def play(dut):
    """Note the counts of each frame."""
    Clock(dut.clk, 10, unit="ns").start()
    dut.rst.value = 1
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    rows = []
    for _ in range(FRAMES):
        await RisingEdge(dut.swap_valid)
        counts = (dut.cycles, dut.words, dut.bursts)
        rows.append([int(count.value) for count in counts])
    Path(os.environ["SPLATLINE_COUNTS"]).write_text(json.dumps(rows))


def measure(config, data_bits, beats):
    """Return cycles, words and bursts of each of the frames."""
    text = PLAYER.replace("BITS", str(config.raster_end.end)).replace("COUNT", str(len(beats)))
    text = text.replace("LANES", str(data_bits // 8))
    verilog = convert(FrameWriter(config, data_bits), "writer")
    built = simulator.build({"writer.v": verilog, "player.v": text}, "player")
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        file, counts = Path(scratch) / "beats.hex", Path(scratch) / "counts.json"
        numbers = (sum(int(limb) << 64 * n for n, limb in enumerate(row)) for row in beats)
        file.write_text("\n".join(f"{number:x}" for number in numbers))
        environment = {"SPLATLINE_COUNTS": str(counts)}
        simulator.run(built, Path(__file__), plusargs=[f"+beats={file}"], environment=environment)
        return json.loads(counts.read_text())


def print_cycles():
    """Print the table of cycles."""
    heads = "scene", "empty lines", "engine", "bus", "all lines", "bytes", "skipping", "bytes"
    print("| " + " | ".join(heads) + " |\n|---|" + "---:|" * 7)
    for name in SCENES:
        scene = load_scene(name)
        view = fit_view(
            scene.cloud, size=(SIZE, SIZE), orbit=scene.orbit, fov=scene.fov, up=scene.up,
            zoom=scene.zoom,
        )  # fmt: skip
        frame = make_frame(scene.cloud, view, radii=splat_radii(scene.cloud), config=RGB24)
        picture = golden.render(frame)
        beats, engine = to_beats(picture), count_cycles(frame)
        empty = int((~picture.drawn.any(axis=1)).sum())
        for bits in WIDTHS:
            rows = measure(RGB24, bits, beats)
            (cycles, words, _), (fewer, kept, _) = rows[1], rows[-1]
            print(
                f"| {name} | {empty} | {engine:,} | {bits} | {cycles:,} | {words * bits // 8:,}"
                f" | {fewer:,} | {kept * bits // 8:,} |"
            )


def count_ecp5(component):
    """Return the LUTs, flip-flops and block RAMs of a component in an ECP5."""
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "writer.v").write_text(convert(component, "writer"))
        script = "read_verilog writer.v; synth_ecp5 -top writer; tee -o stat.json stat -json"
        run_yosys(script, folder)
        modules = json.loads((folder / "stat.json").read_text())["modules"]
    cells = modules["\\writer"]["num_cells_by_type"]
    kinds = {"LUTs": "LUT4", "carries": "CCU2C", "flip-flops": "TRELLIS_FF"}
    kinds |= {"LUT RAMs": "TRELLIS_DPR16X4", "block RAMs": "DP16KD"}
    return {name: cells.get(kind, 0) for name, kind in kinds.items()}


def print_area():
    """Print the table of resources."""
    heads = "preset", "bus", "XC2V: LUTs", "flip-flops", "block RAMs"
    ecp5 = "ECP5: LUTs", "carries", "flip-flops", "LUT RAMs", "block RAMs"
    print("\n| " + " | ".join((*heads, *ecp5)) + " |\n|---|" + "---:|" * 9)
    for config, bits in COUNTED:
        old = count_component(FrameWriter(config, bits))
        new = count_ecp5(FrameWriter(config, bits))
        row = config.name, bits, old["lut4"], old["ff"], old["bram"], *new.values()
        print("| " + " | ".join(map(str, row)) + " |")


if __name__ == "__main__":
    print_cycles()
    print_area()
