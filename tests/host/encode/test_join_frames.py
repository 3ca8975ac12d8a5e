import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER, PLANE, RGB24
from splatline.host.cloud.bulk import select
from splatline.host.encode.join_frames import join_frames
from splatline.host.pipeline import make_frame
from splatline.host.shading.materials import Materials, find_materials
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.clouds import cloud_of

SKIPS = frozenset({"outside", "facing_away", "no_pixel"})


def scattered(seed, count=1500):
    """Points of any place, slant, size and colour; many pixels have several of one depth."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(-1, 1, (count, 3)) * (1, 1, rng.choice([0.02, 1]))
    cloud = cloud_of(places, rng.normal(size=(count, 3)))
    cloud = dataclasses.replace(cloud, colours=rng.integers(0, 256, (count, 3), np.uint8))
    return cloud, rng.uniform(0.0, 0.05, count) * rng.choice([1, 3], count), rng


def frames_of(cloud, radii, parts, config, **options):
    """The frame of a cloud, and those of its parts: part of each point, with what they share."""
    view = fit_view(cloud, size=(150, 110), radii=radii)
    materials = find_materials(cloud, 1 << config.material_bits)
    shared = {"config": config, "skips": SKIPS, **options}
    whole = make_frame(cloud, view, radii=radii, materials=materials, **shared)
    shared["depth_range"] = tuple(whole.counts["depth_range"])
    found = []
    for part in range(parts.max() + 1):
        kept = parts == part
        of_part = Materials(materials.palette, materials.index[kept])
        frame = make_frame(
            select(cloud, kept), view, radii=radii[kept], materials=of_part, **shared
        )
        found.append(frame)
    return whole, found


@pytest.mark.parametrize(
    ("config", "quality"),
    [(RGB24, "exact"), (RGB24, "fast"), (PAPER, "paper"), (PLANE, "exact")],
    ids=lambda value: getattr(value, "name", value),
)
@pytest.mark.parametrize("seed", range(4))
def test_parts_of_a_cloud_give_its_picture_in_any_order_and_any_groups(config, quality, seed):
    cloud, radii, rng = scattered(seed)
    parts = rng.integers(0, 4, len(cloud))
    # In a long range nearly all points have one depth, so that the order alone decides.
    limits = None if seed % 2 else (0.0, 1e3)
    options = {"quality": quality, "depth_range": limits}
    whole, frames = frames_of(cloud, radii, parts, config, **options)
    picture = golden.render(whole)
    joined = join_frames(frames)
    assert golden.render(joined).mismatches(picture) == 0
    by_twos = join_frames([frames[2], join_frames([frames[3], frames[0]]), frames[1]])
    assert np.array_equal(by_twos.codewords, joined.codewords)
    assert joined.counts["elements"] <= picture.drawn.sum()
    assert len(joined.codewords) < len(whole.codewords)
    assert joined.counts["codewords"] == len(joined.codewords)


def test_every_word_of_a_joined_frame_shows_a_pixel():
    cloud, radii, _ = scattered(7, 300)
    whole, _ = frames_of(cloud, radii, np.zeros(len(cloud), int), RGB24)
    joined = join_frames([whole])
    picture = golden.render(joined)
    control = golden.decode(joined.codewords, RGB24)["control"]
    for number in np.flatnonzero(~control):
        less = dataclasses.replace(joined, codewords=np.delete(joined.codewords, number))
        assert golden.render(less).mismatches(picture) > 0


def test_an_empty_frame_adds_nothing():
    cloud, radii, _ = scattered(8, 200)
    whole, _ = frames_of(cloud, radii, np.zeros(len(cloud), int), PLANE)
    empty = dataclasses.replace(whole, codewords=whole.codewords[-1:])
    assert len(join_frames([empty]).codewords) == 1
    both = join_frames([empty, whole])
    assert golden.render(both).mismatches(golden.render(whole)) == 0


def test_frames_that_do_not_belong_together_are_refused():
    cloud, radii, _ = scattered(9, 200)
    whole, _ = frames_of(cloud, radii, np.zeros(len(cloud), int), RGB24)
    with pytest.raises(InputError, match="two sizes"):
        join_frames([whole, dataclasses.replace(whole, width=99)])
    tables = dataclasses.replace(whole.tables, ambient=whole.tables.ambient + 1)
    with pytest.raises(InputError, match="two tables 'ambient'"):
        join_frames([whole, dataclasses.replace(whole, tables=tables)])
    with pytest.raises(InputError, match="cut short"):
        join_frames([dataclasses.replace(whole, codewords=whole.codewords[:-1])])
