"""Stimuli of benches: bits made and taken apart as Amaranth does it."""

import random
from types import SimpleNamespace

import pytest
from amaranth.lib import data

from splatline.contract.presets import PAPER, SWIFT
from splatline.rtl.blocks.layouts import BlockLayout
from splatline.rtl.layouts import GeometryLayout, RasterLayout
from splatline.rtl.tiles.layouts import TileLayout
from splatline.sim.cosim.blocks import pack, unpack

LAYOUTS = [
    layout(config)
    for config, *own in ((PAPER, TileLayout), (SWIFT, BlockLayout))
    for layout in (*own, GeometryLayout, RasterLayout)
]


def plain(value):
    """Namespaces as dicts, all the way down."""
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, SimpleNamespace):
        return {name: plain(item) for name, item in vars(value).items()}
    return value


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: type(layout).__name__)
def test_bits_are_those_of_amaranth(layout):
    rng = random.Random(3)
    for _ in range(20):
        bits = rng.getrandbits(layout.size)
        values = plain(unpack(layout, bits))
        assert layout.const(values).as_value().value == bits
        assert pack(layout, **values) == bits


def test_what_is_not_named_is_zero_and_what_is_too_wide_is_cut():
    layout = data.StructLayout({"low": 3, "high": data.ArrayLayout(2, 2)})
    assert pack(layout, high=[1, 3]) == 0b1101_000
    assert pack(layout, low=-1) == 0b111
    with pytest.raises(KeyError):
        pack(layout, middle=1)
