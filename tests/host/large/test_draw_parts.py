import dataclasses
import functools

import laspy
import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import PLANE, RGB24
from splatline.host.cloud.spacing import measure_discs
from splatline.host.files.readers import read_cloud
from splatline.host.files.wanted import ColourBy
from splatline.host.large import pieces, plan
from splatline.host.large.draw_parts import Drawing, draw_part, draw_parts, frames_of, join_parts
from splatline.host.large.plan import make_plan
from splatline.host.pipeline import make_frame
from splatline.host.visibility.view import fit_view
from splatline.sim import golden

SIZE = 96, 80


def hills(count, seed=1):
    """Points of hills in map coordinates, with noise and colours."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 100, (2, count))
    z = 10 * np.sin(x / 12) * np.cos(y / 9) + rng.normal(0, 0.02, count)
    colours = np.stack([2.5 * x, 2.5 * y, np.full(count, 90.0)], axis=1)
    return np.stack([x + 5e5, y + 5e6, z], axis=1), colours.astype(np.uint16) * 257


def write_las(path, positions, colours, **fields):
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [5e5, 5e6, 0]
    las = laspy.LasData(header)
    las.x, las.y, las.z = positions.T
    las.red, las.green, las.blue = colours.T
    for name, values in fields.items():
        las[name] = values
    las.write(path)
    return path


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    positions, colours = hills(60_000)
    intensity = (positions[:, 0] - 5e5) * 600
    classes = np.where(positions[:, 2] > 0, 5, 2)
    path = tmp_path_factory.mktemp("large") / "hills.laz"
    return write_las(path, positions, colours, intensity=intensity, classification=classes)


def plan_of(*paths, by=None, config=RGB24, **options):
    fit = functools.partial(fit_view, size=SIZE, up="z", **options)
    return make_plan(paths, by, fit, 1 << config.material_bits)


def picture(plan, drawing=Drawing()):  # noqa: B008  (it is frozen)
    parts = draw_parts(plan, drawing)
    (frame,) = frames_of(plan, drawing, parts)
    return golden.render(frame), parts


@pytest.fixture
def small_parts(monkeypatch):
    monkeypatch.setattr(plan, "PART_POINTS", 17_000)
    monkeypatch.setattr(pieces, "PIECE", 5000)


def test_a_thinned_scan_looks_as_all_of_its_points_do(scan):
    settled = plan_of(scan)
    drawn, parts = picture(settled)
    assert parts.points == settled.count == 60_000
    assert parts.dropped["finer"] > 10_000
    cloud = read_cloud(scan)
    view = dataclasses.replace(settled.view, eye=settled.view.eye + settled.origin - cloud.origin)
    discs = measure_discs(cloud).drawn(close_specks=False)._asdict()
    whole = golden.render(make_frame(cloud, view, **discs, depth_range=settled.depth_range))
    assert np.mean(whole.drawn == drawn.drawn) > 0.99
    error = np.mean((drawn.to_rgb() - whole.to_rgb()) ** 2)
    assert -10 * np.log10(error) > 27


@pytest.mark.parametrize("config", [RGB24, PLANE], ids=lambda config: config.name)
def test_parts_may_be_drawn_and_joined_in_any_order(scan, small_parts, config):
    settled, drawing = plan_of(scan, config=config), Drawing(config=config, samples=4)
    assert len(settled.parts) == 4
    joined = draw_parts(settled, drawing)
    frames = frames_of(settled, drawing, joined)
    assert len(frames) == 4
    assert joined.points == 60_000
    a, b, c, d = (draw_part(settled, part, drawing) for part in settled.parts)
    other = frames_of(settled, drawing, join_parts([join_parts([d, b]), join_parts([c, a])]))
    for one, two in zip(frames, other, strict=True):
        assert np.array_equal(one.codewords, two.codewords)
        assert one.counts == two.counts
    counts = frames[0].counts
    assert counts["points"] == 60_000
    assert counts["codewords"] == len(frames[0].codewords)
    kept = 60_000 - sum(counts["dropped"].values())
    assert 4 * kept == counts["elements"] + sum(counts["culled"].values())


def test_pieces_play_no_part(scan, monkeypatch):
    settled = plan_of(scan)
    wanted, _ = picture(settled)
    monkeypatch.setattr(pieces, "PIECE", 999)
    found, _ = picture(settled)
    assert found.mismatches(wanted) == 0


def test_several_files_are_one_picture(tmp_path):
    positions, colours = hills(30_000, 2)
    left = positions[:, 0] < 5e5 + 50
    one = write_las(tmp_path / "left.las", positions[left], colours[left])
    two = write_las(tmp_path / "right.laz", positions[~left], colours[~left])
    three = tmp_path / "tower.xyz"
    three.write_text("\n".join(f"500050 5000050 {height}" for height in range(20, 40)))
    settled = plan_of(one, two, three)
    drawn, parts = picture(settled)
    assert parts.points == 30_020
    whole, _ = picture(plan_of(write_las(tmp_path / "both.las", positions, colours)))
    assert drawn.drawn.sum() > 0.5 * whole.drawn.sum()
    assert drawn.drawn[:5].any() or drawn.drawn[5:20].any()


@pytest.mark.parametrize(
    "by",
    [
        ColourBy("height", up="z"),
        ColourBy("height", range=(-5.0, 5.0), up="z"),
        ColourBy("intensity"),
        ColourBy("classification"),
        ColourBy("intensity", map="magma"),
        None,
    ],
    ids=str,
)
def test_each_part_has_the_colours_of_the_whole(scan, small_parts, by):
    settled = plan_of(scan, by=by)
    drawn, _ = picture(settled)
    cloud = read_cloud(scan, colour=by)
    view = dataclasses.replace(settled.view, eye=settled.view.eye + settled.origin - cloud.origin)
    discs = measure_discs(cloud).drawn(close_specks=False)._asdict()
    whole = golden.render(make_frame(cloud, view, **discs, depth_range=settled.depth_range))
    both = whole.drawn & drawn.drawn
    unlike = np.abs(whole.to_rgb() - drawn.to_rgb())[both].mean()
    assert unlike < 0.04


def test_a_file_without_colours_is_drawn_by_its_intensity(tmp_path, small_parts):
    positions, colours = hills(40_000, 3)
    path = write_las(
        tmp_path / "dark.las", positions, 0 * colours, intensity=(positions[:, 0] - 5e5) * 600
    )
    drawn, parts = picture(plan_of(path, orbit=(0, 60)))
    assert parts.used["intensity"].startswith("intensity")
    colour = drawn.colour.astype(int)
    assert (np.ptp(colour, axis=2)[drawn.drawn] <= 8).all()  # grey
    left, right = colour[:, :30].max(), colour[:, -30:].max()
    assert abs(left - right) > 30


def test_less_memory_gives_coarser_cells_and_says_so(scan, monkeypatch):
    settled = plan_of(scan)
    monkeypatch.setattr("splatline.host.large.read_part.FEWEST_CELLS", 2000)
    drawn, parts = picture(settled, Drawing(memory=1))
    assert any("pixels are drawn as one" in note for note in parts.notes)
    assert parts.elements < 2000
    assert drawn.drawn.sum() > 500


def test_strays_do_not_make_the_picture_small(tmp_path):
    positions, colours = hills(20_000, 4)
    usual, _ = picture(plan_of(write_las(tmp_path / "a.las", positions, colours)))
    positions[7] += (4000, -3000, 2000)
    drawn, parts = picture(plan_of(write_las(tmp_path / "b.las", positions, colours)))
    assert drawn.drawn.sum() > 0.9 * usual.drawn.sum()
    assert parts.dropped["outside"] == 1


def test_a_view_that_shows_nothing_is_one_line(scan):
    settled = plan_of(scan)
    away = dataclasses.replace(settled.view, axes=settled.view.axes * [[1], [-1], [-1]])
    words = r"nothing of hills.laz is in view: of ([\d,]+) points, \1 outside; change the view"
    with pytest.raises(InputError, match=words):
        draw_parts(dataclasses.replace(settled, view=away), Drawing(samples=4))


def test_a_damaged_file_is_told_by_its_name(scan, tmp_path):
    path = tmp_path / "cut.laz"
    path.write_bytes(scan.read_bytes()[:90_000])
    with pytest.raises(InputError, match=r"cut\.laz: "):
        draw_parts(plan_of(path), Drawing())
    with pytest.raises(InputError, match=r"none\.laz: cannot be read"):
        plan_of(tmp_path / "none.laz")
