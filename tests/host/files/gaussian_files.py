"""Gaussian splats in the columns of the reference implementation's writer."""

import io

import numpy as np
from plyfile import PlyData, PlyElement

from tests.host.files.cloud_files import COLOURS, COUNT, POSITIONS

RNG = np.random.default_rng(5)
ROTATIONS = RNG.normal(size=(COUNT, 4))
SCALES = RNG.uniform(-6.0, -2.0, (COUNT, 3))
OPACITY = np.linspace(-3.0, 5.0, COUNT)


def gaussians(opacity=OPACITY, scales=SCALES):
    columns = dict(zip("xyz", POSITIONS.T, strict=True))
    columns |= dict.fromkeys(("nx", "ny", "nz"), np.zeros(COUNT))
    columns |= {f"f_dc_{i}": (COLOURS[:, i] / 255.0 - 0.5) / 0.28209479177387814 for i in range(3)}
    columns |= {f"f_rest_{i}": RNG.normal(size=COUNT) for i in range(45)}
    columns |= {"opacity": opacity}
    columns |= {f"scale_{i}": scales[:, i] for i in range(3)}
    columns |= {f"rot_{i}": ROTATIONS[:, i] for i in range(4)}
    rows = np.empty(COUNT, [(name, "f4") for name in columns])
    for name, values in columns.items():
        rows[name] = values
    return rows


def ply_bytes(rows):
    stream = io.BytesIO()
    PlyData([PlyElement.describe(rows, "vertex")]).write(stream)
    return stream.getvalue()
