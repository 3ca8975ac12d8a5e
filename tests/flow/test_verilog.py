import re

import pytest

from splatline.contract.presets import PAPER
from splatline.flow.verilog import generate


@pytest.fixture(scope="module")
def generated():
    return generate(PAPER)


def test_the_same_source_gives_the_same_text(generated):
    assert generate(PAPER) == generated


def test_the_text_names_no_file_of_this_machine(generated):
    text, _ = generated
    assert "/rtl/" not in text
    assert "site-packages" not in text


def test_the_sidecar_lists_exactly_the_top_module_s_ports(generated):
    text, sidecar = generated
    top = re.search(r"^module splatline\(([^)]*)\);(.*?)^endmodule", text, re.DOTALL | re.MULTILINE)
    names = {name.strip() for name in top.group(1).split(",")}
    assert names == {port["name"] for port in sidecar["ports"]}
    for port in sidecar["ports"]:
        width = f"[{port['width'] - 1}:0] " if port["width"] > 1 else ""
        declaration = f"  {port['direction']} {width}{port['name']};"
        assert declaration in top.group(2), port
        assert port["meaning"]


def test_the_sidecar_s_fields_cover_their_port_without_gaps(generated):
    _, sidecar = generated
    for port in sidecar["ports"]:
        if "fields" in port:
            places = sorted((field["lsb"], field["width"]) for field in port["fields"])
            ends = [lsb + width for lsb, width in places]
            assert [lsb for lsb, _ in places] == [0, *ends[:-1]]
            assert ends[-1] == port["width"]
    codeword = next(p for p in sidecar["ports"] if p["name"] == "codewords__payload")
    fields = {field["name"]: field["lsb"] for field in codeword["fields"]}
    assert fields["scans[2].last"] == PAPER.last(2).lsb
    assert fields["z"] == PAPER.z.lsb


def test_the_sidecar_says_how_it_was_made(generated):
    _, sidecar = generated
    assert sidecar["config"]["name"] == "paper"
    assert sidecar["tools"]["amaranth"]
    assert sidecar["latency"]["clear_after_reset_cycles"] == 512


def test_the_top_module_can_be_renamed():
    text, sidecar = generate(PAPER, "painter")
    assert sidecar["top"] == "painter"
    assert re.search(r"^module painter\(", text, re.MULTILINE)
    assert re.search(r"^module painter__window\(", text, re.MULTILINE)
    assert "module splatline" not in text


def test_the_share_that_is_written_is_told():
    told = []
    assert generate(PAPER, progress=told.append)[0] == generate(PAPER)[0]
    assert told == sorted(told) and len(told) >= 3 and told[-1] == 1.0
