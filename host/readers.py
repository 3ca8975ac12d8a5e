"""Cloud files of every supported format, read into a :class:`Cloud`."""

from __future__ import annotations

import os
from pathlib import Path

from .cloud import Cloud

__all__ = ["read_cloud"]


def read_cloud(path: str | os.PathLike[str]) -> Cloud:
    import numpy as np
    from plyfile import PlyData
    v = PlyData.read(str(path))["vertex"].data
    p = np.stack([v[k].astype(float) for k in "xyz"], -1)
    n = np.stack([v[k] for k in ("nx", "ny", "nz")], -1).astype(np.float32)
    c = np.stack([v[k] for k in ("red", "green", "blue")], -1) if "red" in v.dtype.names else np.full((len(p), 3), 200, np.uint8)
    o = 0.5 * (p.min(0) + p.max(0))
    return Cloud(p - o, n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-9).astype(np.float32), c, np.zeros(len(p), bool), o, Path(path).stem, {})
