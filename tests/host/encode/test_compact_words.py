"""Compact words from the host: the same pictures as with its own table, and no look-up."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER
from splatline.contract.variants import SHAPED
from splatline.host.encode import encode as host_encode
from splatline.host.encode.shape_table import shape_table
from splatline.host.pipeline import make_frame
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from splatline.sim.golden.compact_words import expand_frame
from tests.support.clouds import cloud_of, sphere

SMALL, FULL = SHAPED


def both_ways(cloud, view, radii, config):
    """Frames with the host's table and with the engine's ROM."""
    return [
        make_frame(cloud, view, radii=radii, config=config, quality="paper", shapes=shapes)
        for shapes in ("table", "rom")
    ]


def scattered(seed, count=1500):
    """Points with normals and sizes of every kind."""
    rng = np.random.default_rng(seed)
    cloud = cloud_of(rng.uniform(-1, 1, (count, 3)), rng.normal(size=(count, 3)))
    return cloud, rng


@pytest.mark.parametrize("config", SHAPED, ids=lambda config: config.name)
@pytest.mark.parametrize("seed", range(6))
def test_pictures_are_the_same_to_the_bit(config, seed):
    """Across every border, for all sizes up to those that no ROM holds."""
    cloud, rng = scattered(seed)
    radii = rng.uniform(0.0, 0.02, len(cloud)) * rng.choice([1, 2, 8], len(cloud))
    size = tuple(int(side) for side in rng.integers(20, 200, 2))
    view = fit_view(cloud, size=size, orbit=(30 * seed, 20), zoom=rng.choice([0.7, 1.5, 4.0]))
    table, rom = both_ways(cloud, view, radii, config)
    expected, found = golden.render(table), golden.render(rom)
    # Words of more than eight columns come in another order than their halves, so that of two
    # elements of one depth the other may stay.
    assert np.array_equal(found.depth, expected.depth)
    assert found.mismatches(expected) <= (0 if config is SMALL else expected.drawn.sum() // 500)
    assert expected.drawn.any()
    assert not np.array_equal(table.codewords, rom.codewords)


@pytest.mark.parametrize("config", SHAPED, ids=lambda config: config.name)
def test_what_the_rom_makes_of_them_are_the_words_with_the_table(config):
    """Word for word, where no element crosses a border; only that right comes after left."""
    cloud, rng = scattered(9)
    radii = rng.uniform(0.005, 0.06, len(cloud))
    view = fit_view(cloud, size=(200, 200), zoom=0.6)
    table, rom = both_ways(cloud, view, radii, config)
    expanded = expand_frame(rom)
    for part, other in zip(by_line(table), by_line(expanded), strict=True):
        assert np.array_equal(np.sort(part), np.sort(other))
    assert table.counts["elements"] == rom.counts["elements"]


def by_line(frame):
    """The words between control words."""
    control = np.flatnonzero(golden.decode(frame.codewords, frame.config)["control"])
    return np.split(frame.codewords, control + 1)


def test_the_host_looks_nothing_up(monkeypatch):
    """With a table of nonsense the words are the same, as all elements lie inside."""
    cloud, rng = scattered(10)
    radii = rng.uniform(0.005, 0.06, len(cloud))
    view = fit_view(cloud, size=(200, 200), zoom=0.6)
    table, rom = both_ways(cloud, view, radii, FULL)
    monkeypatch.setattr(host_encode, "shape_table", lambda: np.zeros_like(shape_table()))
    table_again, rom_again = both_ways(cloud, view, radii, FULL)
    assert np.array_equal(rom.codewords, rom_again.codewords)
    assert not np.array_equal(table.codewords, table_again.codewords)


def test_the_bits_that_were_sent_are_counted():
    """As many words for elements of up to eight pixels, about half for those of sixteen."""
    cloud = sphere(400)
    view = fit_view(cloud, size=(300, 300))
    bits = {}
    for pixels in (3, 10):
        radii = np.full(len(cloud), 0.5 * pixels * np.linalg.norm(view.eye) / view.focal)
        for frame in both_ways(cloud, view, radii, FULL):
            [(shapes, sent)] = frame.counts["bits_sent"].items()
            assert sent == 64 * len(frame.codewords)
            bits[pixels, shapes] = sent
    assert bits[3, "rom"] == bits[3, "table"]
    assert 0.45 < bits[10, "rom"] / bits[10, "table"] < 0.7


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"config": SMALL, "quality": "exact"}, "quality paper, not exact"),
        ({"config": SMALL, "quality": "fast"}, "quality paper, not fast"),
        ({"config": PAPER, "quality": "paper"}, "preset paper has no shape ROM"),
        ({"config": SMALL, "quality": "paper", "skips": {"hidden"}}, "skip hidden"),
        (
            {"config": SMALL, "quality": "paper", "shapes": "disc"},
            "no source of shapes named 'disc'",
        ),
    ],
)
def test_what_a_rom_does_not_go_with_is_said(options, message):
    cloud = sphere(100)
    view = fit_view(cloud, size=(64, 64))
    with pytest.raises(InputError, match=message):
        make_frame(cloud, view, radii=np.full(100, 0.1), **{"shapes": "rom", **options})
