"""Frames of the built-in scenes, as ``splatline render`` makes them."""

from splatline.contract.presets import PAPER
from splatline.host import fit_view, load_scene, make_frame, splat_radii

__all__ = ["scene_frame"]


def scene_frame(name, scale=1.0, *, view=None, config=PAPER, **options):
    """Return a scene's frame; ``scale``: scale of splats; ``view``: changes of the scene's view."""
    scene = load_scene(name)
    seen = {"orbit": scene.orbit, "fov": scene.fov, "up": scene.up, **(view or {})}
    return make_frame(
        scene.cloud,
        fit_view(scene.cloud, **seen),
        radii=scale * splat_radii(scene.cloud),
        config=config,
        **options,
    )
