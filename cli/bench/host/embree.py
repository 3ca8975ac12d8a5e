"""Embree, the usual ray tracer for processors: the same discs, a ray for each pixel.

``embree_discs.c`` is compiled when it is first needed, so Splatline needs neither Embree nor a C
compiler to be installed.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View

__all__ = ["EmbreeMissingError", "EmbreeScene", "compile_library"]

SOURCE = Path(__file__).with_name("embree_discs.c")

FLAGS = ("-std=c11", "-O3", "-march=native", "-shared", "-fPIC")

LIGHT = (-0.48, -0.67, -0.57)
"""Towards the light in camera axes; of length 1."""


class EmbreeMissingError(Exception):
    """Embree or a C compiler is not installed; the message says what to install."""


class EmbreeScene:
    """A cloud's discs in Embree's tree, as a context.

    The tree has the best quality that Embree builds.

    Parameters
    ----------
    cloud
        The points; their discs are seen from both sides.
    radii
        Radius of each disc: shape (n,).

    Attributes
    ----------
    build_seconds
        Time to build the tree from arrays in Embree's own layout.

    Raises
    ------
    EmbreeMissingError
        If it cannot be compiled here.
    RuntimeError
        If Embree fails.
    """

    def __init__(self, cloud: Cloud, radii: npt.NDArray[np.float64]) -> None:
        import numpy as np

        self._library = compile_library()
        self._threads = len(os.sched_getaffinity(0))
        points = np.empty((len(cloud), 4), np.float32)
        points[:, :3], points[:, 3] = cloud.positions, radii
        # Embree reads 16 bytes at once, so the last normal has a float behind it.
        normals = np.zeros(3 * len(cloud) + 1, np.float32)
        normals[:-1] = cloud.normals.ravel()
        self._arrays = points, normals, np.ascontiguousarray(cloud.colours)
        addresses = (array.ctypes.data for array in self._arrays)
        begin = time.perf_counter()
        self._discs = self._library.discs_build(*addresses, len(cloud), self._threads)
        self.build_seconds = time.perf_counter() - begin
        if not self._discs:
            raise RuntimeError("Embree does not start")

    def __enter__(self) -> EmbreeScene:
        error = self._library.discs_error(self._discs)
        if error:
            self.__exit__()
            raise RuntimeError(f"Embree fails with its error {error}")
        return self

    def __exit__(self, *_: object) -> None:
        self._library.discs_free(self._discs)

    def draw(self, view: View) -> tuple[float, npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
        """Draw a frame on all cores.

        Returns
        -------
        seconds
            Its time, without that of the arrays.
        depth
            Distance along the view: shape (height, width); infinite where no disc is hit.
        colour
            Shape (height, width, 3): the point's colour times the cosine to the light.
        """
        import numpy as np

        camera = np.array(
            [*view.eye, *view.axes.ravel(), view.focal, *view.middle, view.near], np.float32
        )
        light = np.asarray(np.array(LIGHT) @ view.axes, np.float32)
        depth = np.empty((view.height, view.width), np.float32)
        colour = np.empty((view.height, view.width, 3), np.uint8)
        begin = time.perf_counter()
        failed = self._library.discs_draw(
            self._discs,
            camera.ctypes.data,
            light.ctypes.data,
            view.width,
            view.height,
            self._threads,
            depth.ctypes.data,
            colour.ctypes.data,
        )
        seconds = time.perf_counter() - begin
        if failed:
            raise RuntimeError("a thread cannot be started")
        return seconds, depth, colour


def compile_library() -> Any:
    """Return the library of ``embree_discs.c``, which is compiled each time: half a second.

    Raises
    ------
    EmbreeMissingError
        If Embree or a compiler is not installed.
    RuntimeError
        If it does not compile for another reason.
    """
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise EmbreeMissingError("there is no C compiler: apt-get install gcc")
    with tempfile.TemporaryDirectory(prefix="splatline-") as folder:
        file = Path(folder, "embree_discs.so")
        # Libraries last, since the linker looks for what the object before them lacks.
        command = [compiler, *FLAGS, "-o", str(file), str(SOURCE), "-lembree3", "-lpthread"]
        made = subprocess.run(command, capture_output=True, text=True, check=False)
        if made.returncode:
            missing = ("embree3/", "-lembree3")
            if any(word in made.stderr for word in missing):
                raise EmbreeMissingError("Embree is not installed: apt-get install libembree-dev")
            raise RuntimeError(f"embree_discs.c does not compile: {made.stderr.strip()[:150]}")
        library = ctypes.CDLL(str(file))
    pointer, number = ctypes.c_void_p, ctypes.c_int
    library.discs_build.argtypes = [pointer, pointer, pointer, ctypes.c_uint, number]
    library.discs_build.restype = pointer
    library.discs_error.argtypes = library.discs_free.argtypes = [pointer]
    library.discs_free.restype = None
    library.discs_draw.argtypes = [pointer] * 3 + [number] * 3 + [pointer] * 2
    return library
