import numpy as np
import pytest

from splatline.cli.bench.host import embree
from splatline.cli.bench.host.embree import EmbreeMissingError, EmbreeScene
from splatline.host.cloud.resample import resample
from splatline.host.cloud.spacing import splat_radii
from splatline.host.pipeline import make_frame
from splatline.host.scenes.scenes import load_scene
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import fit_view
from splatline.sim import golden, reference


@pytest.fixture(scope="module")
def drawn():
    """A scene of 20,000 points, and Embree's picture of it, of a size that no tile divides."""
    scene = load_scene("knot")
    cloud, _ = resample(scene.cloud, splat_radii(scene.cloud), 20_000)
    radii = splat_radii(cloud)
    view = fit_view(cloud, orbit=scene.orbit, up=scene.up, size=(203, 150))
    try:
        with EmbreeScene(cloud, radii) as peer:
            pictures = [peer.draw(view) for _ in range(2)]
    except EmbreeMissingError as error:
        pytest.skip(str(error))
    return cloud, radii, view, pictures


def agreement(one, other):
    """Return the overlap of two depth pictures, and the median difference where both are drawn."""
    hit, struck = np.isfinite(one), np.isfinite(other)
    both = hit & struck
    return both.sum() / (hit | struck).sum(), np.median(np.abs(one - other)[both])


def test_embree_casts_rays_at_the_discs_of_the_exact_reference(drawn):
    cloud, radii, view, ((seconds, depth, colour), (_, again, _)) = drawn
    assert seconds > 0.0
    assert np.array_equal(depth, again)
    exact = reference.render(cloud, view, radii, Lighting(), samples=1)
    overlap, apart = agreement(depth, exact.depth)
    assert overlap > 0.99
    assert apart < 1e-5 * np.nanmax(exact.depth)
    assert (colour[np.isinf(depth)] == 255).all()
    assert len(np.unique(colour[np.isfinite(depth)], axis=0)) > 100


def test_embree_and_golden_draw_the_same_picture(drawn):
    cloud, radii, view, ((_, depth, _), _) = drawn
    frame = make_frame(cloud, view, radii=radii, quality="fast")
    raster = golden.render(frame)
    low, high = frame.counts["depth_range"]
    levels = raster.config.background_depth - 1
    ours = np.where(raster.drawn, low + raster.depth / levels * (high - low), np.nan)
    overlap, apart = agreement(depth, ours)
    assert overlap > 0.97
    # A splat of ours has one depth, that of its middle.
    assert apart < 0.01 * (high - low)


@pytest.mark.parametrize(
    ("said", "error", "message"),
    [
        ("embree_discs.c:7:10: fatal error: embree3/rtcore.h: No such file", EmbreeMissingError,
         "apt-get install libembree-dev"),
        ("ld: cannot find -lembree3", EmbreeMissingError, "apt-get install libembree-dev"),
        ("embree_discs.c:9: error: expected ;", RuntimeError, "does not compile"),
    ],
)  # fmt: skip
def test_what_is_missing_is_named_with_its_package(monkeypatch, tmp_path, said, error, message):
    compiler = tmp_path / "cc"
    compiler.write_text(f"#!/bin/sh\necho '{said}' >&2\nexit 1\n")
    compiler.chmod(0o755)
    monkeypatch.setattr(embree.shutil, "which", lambda name: str(compiler))
    with pytest.raises(error, match=message):
        embree.compile_library()


def test_a_compiler_is_asked_for(monkeypatch):
    monkeypatch.setattr(embree.shutil, "which", lambda name: None)
    with pytest.raises(EmbreeMissingError, match="apt-get install gcc"):
        embree.compile_library()
