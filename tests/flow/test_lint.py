"""What three linters say of the Verilog: Verilator, slang and Icarus, each with all warnings."""

import fnmatch
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from splatline.contract.presets import LANES8, PAPER, PLANE, RGB24, SWIFT_PLANE
from splatline.contract.variants import CONFIGS
from splatline.flow.area.synth import NAME
from splatline.flow.chain_verilog import generate_chain
from splatline.sim.cosim import simulator
from tests.support.engines import verilog

FLOW = Path(__file__).parents[2] / "flow"
WAIVERS, OPTIONS = FLOW / "verilator.vlt", FLOW / "slang.f"

TOPS = [
    (PAPER, "engine"),
    (PAPER, "chain"),
    (CONFIGS["paper-rom"], "engine"),
    (CONFIGS["small"], "engine"),
    (RGB24, "framebuffer"),
    (RGB24.with_memory("simple"), "axi"),
    (LANES8, "engine"),
    (PLANE, "axi"),
    (SWIFT_PLANE, "pins"),
]
"""Each top, each kind of memory and of window, with and without planes and a shape ROM."""

UNREAD = {
    "rst": "the state of the module is a memory",
    "active": "an engine of a chain whose frames start empty loads no raster",
    "i__valid": "the same engine",
    "line": "its lower bits say where in the window it lies",
    "load_word": "two words have one mark",
    "bus__bresp": "its upper bit is the error",
    "s_axis_codewords_tdata": "padding up to whole bytes",
    "s_axis_initial_tdata": "the same",
}
"""Inputs of modules of which not all is read, and why."""

SLANG = """
import sys
from pyslang.driver import CommandLineOptions, Driver
driver = Driver()
driver.addStandardArgs()
good = driver.parseCommandLine(" ".join(["slang", *sys.argv[1:]]), CommandLineOptions())
good = good and driver.processOptions() and driver.parseAllSources()
sys.exit(not (good and driver.runFullCompilation(True)))
"""

BIT_OF_A_WORD = re.compile(
    r"warning: implicit conversion truncates from \d+ to 1 bits \[-Wwidth-trunc\]\n"
    r" +assign \w+ = .* >> [\w\[\]:]+;"
)
"""A bit at an address that is not constant: slang.f says why it is not waived there."""

LONG_CONSTANT = re.compile(r"warning: verinum::as_long\(\) truncated \d+ bits to 63, returns \d+\n")
"""Icarus reads attributes as integers. Yosys' attribute ``init`` repeats the initial value of a
register, which may be longer. Nothing in Icarus reads it."""

in_icarus = pytest.mark.skipif(not simulator.available("icarus"), reason="Icarus is not installed")


@pytest.fixture(scope="module", params=TOPS, ids=lambda top: f"{top[0].name}-{top[1]}")
def text(request):
    return linted(*request.param)


@cache
def linted(config, top):
    """Return the Verilog of a top or of a chain of two engines."""
    return generate_chain(config, 2, name=NAME)[0] if top == "chain" else verilog(config, top)


def run(folder, text, *command):
    """Run a linter in a folder on a text; return its exit code and what it says."""
    (folder / "top.v").write_text(text)
    with simulator._tools_on_path():
        done = subprocess.run(
            [*map(str, command), "top.v"],
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
    return done.returncode, done.stdout


def verilator(folder, text, *more):
    return run(folder, text, "verilator", "--lint-only", "-Wall", "--quiet", "--top", NAME, *more)


def slang(folder, text):
    return run(folder, text, sys.executable, "-c", SLANG, "--top", NAME, "-f", OPTIONS)


def icarus(folder, text):
    return run(folder, text, "iverilog", "-Wall", "-g2005", "-t", "null", "-s", NAME)


def with_a_wider_port(text):
    """Return Verilog in which an instance's first payload is connected to a bit more."""
    found = re.search(r"^    \.(\w+payload)\((\w+)\)", text, re.MULTILINE)
    return text.replace(found[0], f"    .{found[1]}({{ {found[2]}, 1'h0 }})", 1)


def test_verilator_has_no_warning_but_the_waived(text, tmp_path):
    assert verilator(tmp_path, text, WAIVERS) == (0, "")


def test_slang_has_no_warning_but_bits_of_words(text, tmp_path):
    code, said = slang(tmp_path, text)
    assert code == 0
    assert said.count("warning: ") == len(BIT_OF_A_WORD.findall(said)) <= 6


@in_icarus
def test_icarus_has_no_warning_but_of_long_attributes(text, tmp_path):
    code, said = icarus(tmp_path, text)
    assert (code, LONG_CONSTANT.sub("", said)) == (0, "")


@pytest.fixture(scope="module")
def unwaived(tmp_path_factory):
    """What Verilator says of each top but the first without waivers."""
    folder = tmp_path_factory.mktemp("unwaived")
    return [verilator(folder, linted(*top), "-Wno-fatal")[1] for top in TOPS[1:]]


def test_each_waiver_is_needed_and_no_other(unwaived):
    lines = re.findall(r"^lint_off .*", WAIVERS.read_text(), re.MULTILINE)
    found = [re.fullmatch(r'.* -rule (\w+) .* -match "(.*)"', line).groups() for line in lines]
    waivers = [(kind, re.compile(fnmatch.translate(message))) for kind, message in found]
    needed = set()
    for said in unwaived:
        warned = re.findall(
            r"^%(?:Warning|Error)-?(\w*): (?:[\w.]+:\d+:\d+: )?(.*)$", said, re.MULTILINE
        )
        for kind, message in set(warned):
            waived = [n for n, (k, text) in enumerate(waivers) if k == kind and text.match(message)]
            assert len(waived) == 1, (kind, message)
            needed.update(waived)
    assert [found[n] for n in set(range(len(waivers))) - needed] == []


def test_modules_read_their_inputs_but_the_named(unwaived):
    unread = re.compile(r"^%Warning-UNUSEDSIGNAL: .*'(\w+)'.*\n.*\n *\d+ \|   input ", re.MULTILINE)
    assert {name for said in unwaived for name in unread.findall(said)} == set(UNREAD)


def test_files_of_others_are_linted_in_full(tmp_path):
    code, said = verilator(tmp_path, f"module {NAME} (input wire a_b); endmodule", WAIVERS)
    assert code and {"UNUSEDSIGNAL", "DECLFILENAME"} <= set(
        re.findall(r"^%Warning-(\w+)", said, re.M)
    )


def test_a_port_of_another_width_is_found(tmp_path):
    fault = with_a_wider_port(verilog(RGB24))
    code, said = verilator(tmp_path, fault, WAIVERS)
    assert code and "Warning-WIDTH" in said
    _, said = slang(tmp_path, fault)
    assert said.count("warning: ") > len(BIT_OF_A_WORD.findall(said))


@in_icarus
def test_a_port_of_another_width_is_found_by_icarus(tmp_path):
    _, said = icarus(tmp_path, with_a_wider_port(verilog(RGB24)))
    assert "warning: Port" in said
