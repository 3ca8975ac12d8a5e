"""The camera of a render request: fitted to the cloud, or looking at a point."""

from __future__ import annotations

import inspect
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from splatline.cli.report.progress import Stages

from .request import RenderRequest

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.host.cloud.cloud import Cloud
    from splatline.host.scenes.scenes import Scene
    from splatline.host.visibility.view import View

__all__ = ["see", "with_camera"]

FITTED = ("orbit", "fov", "up", "zoom")
"""Values that every camera has."""

AIMED = ("target", "distance")
"""Values of a camera that looks at a point."""


def with_camera(
    request: RenderRequest, stages: Stages
) -> tuple[RenderRequest, dict[str, Any], Scene | None]:
    """Return a request with its up axis, its camera, and its scene if it has one."""
    from splatline.host.visibility.view import fit_view

    scene = None
    parameters = inspect.signature(fit_view).parameters
    camera = {key: parameters[key].default for key in FITTED}
    if request.path is None:
        from splatline.host.files.colouring import check_map
        from splatline.host.scenes.scenes import load_scene

        check_map(request.colour)
        with stages.stage("read", f"Making the scene {request.scene}"):
            scene = load_scene(request.scene)
        camera |= {key: getattr(scene, key) for key in FITTED if hasattr(scene, key)}
    else:
        from splatline.host.files.source import usual_up

        camera["up"] = usual_up(request.path, request.format)
    asked = (*FITTED, *AIMED)
    camera |= {key: value for key in asked if (value := getattr(request, key)) is not None}
    if request.colour is not None:
        request = replace(request, colour=replace(request.colour, up=camera["up"]))
    return request, camera, scene


def see(
    cloud: Cloud,
    camera: dict[str, Any],
    size: tuple[int, int],
    radii: npt.NDArray[np.float64] | None = None,
) -> View:
    """Return what a camera of :func:`with_camera` sees of a cloud; see ``fit_view``, ``look_at``.

    Raises
    ------
    InputError
        If a value is out of its range.
    """
    import numpy as np

    from splatline.host.visibility.look_at import look_at
    from splatline.host.visibility.view import fit_view

    values = dict(camera)
    target, distance = (values.pop(key, None) for key in AIMED)
    if target is None:
        return fit_view(cloud, size=size, radii=radii, **values)
    return look_at(np.asarray(target, np.float64) - cloud.origin, distance, size=size, **values)
