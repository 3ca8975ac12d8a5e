"""The smallest device that an engine fits."""

import pytest

from splatline.flow.area.devices import FAMILIES, smallest_device

ENGINE = {"lut4": 2000, "ff": 800, "bram": 17, "mult": 6}


@pytest.mark.parametrize(
    ("changes", "virtex2", "artix7"),
    [
        ({}, "XC2V250", "XC7A12T"),
        ({"lut4": 3073}, "XC2V500", "XC7A12T"),
        ({"ff": 20000}, "XC2V2000", "XC7A15T"),
        ({"bram": 145}, "XC2V8000", "XC7A50T"),
        ({"mult": 46}, "XC2V1500", "XC7A25T"),
        ({"bram": 731}, None, None),
    ],
)
def test_the_smallest_device_has_enough_of_every_resource(changes, virtex2, artix7):
    counts = ENGINE | changes
    assert smallest_device("Virtex-II", counts) == virtex2
    assert smallest_device("Artix-7", counts) == artix7


@pytest.mark.parametrize("family", FAMILIES)
def test_devices_grow(family):
    sizes = [device.lut4 for device in FAMILIES[family]]
    assert sizes == sorted(sizes)
