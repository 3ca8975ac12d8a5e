"""What tests of the live view share."""

import numpy as np

from splatline.view.events import check_event
from splatline.view.live_cloud import live_cloud
from splatline.view.outputs import Picture
from splatline.view.subject import Subject
from tests.support.clouds import sphere

__all__ = [
    "SIZE",
    "Clock",
    "ball",
    "event",
    "last_picture",
    "pictures",
    "set_to",
    "texts",
    "write_ball",
]

SIZE = (96, 80)
"""Of the pictures of most tests."""


def event(kind, **values):
    """Return an event as the page would send it."""
    return check_event({"type": kind, **values})


def set_to(name, value):
    """Return an event that makes a choice."""
    return event("set", name=name, value=value)


def pictures(outputs):
    """Return the pictures among some outputs."""
    return [output for output in outputs if isinstance(output, Picture)]


def texts(outputs, kind):
    """Return the messages of one type."""
    return [out for out in outputs if isinstance(out, dict) and out["type"] == kind]


def last_picture(session):
    """Let a session work until nothing is due at once; return its last picture."""
    shown = []
    while session.due() == 0.0:
        shown += pictures(session.work())
    return shown[-1]


def write_ball(path, points=1500, size=1.0, middle=(0.0, 0.0, 0.0)):
    """Write a sphere with normals, coloured by place, and a column ``warmth``."""
    random = np.random.default_rng(7)
    normals = random.normal(size=(points, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    colours = np.round(127.5 * (normals + 1.0))
    columns = np.hstack([size * normals + middle, normals, colours, normals[:, :1]])
    head = "x,y,z,nx,ny,nz,red,green,blue,warmth"
    np.savetxt(path, columns, fmt="%.6f", delimiter=",", header=head, comments="")
    return path


class Clock:
    """A clock that is moved by hand."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class _Ball(Subject):
    """A sphere that needs no file."""

    def read(self, colour, progress=lambda text, share: None, base=None):
        return live_cloud(sphere(2000), progress=progress)


def ball(**options):
    """Return a sphere of radius 1 as a subject."""
    return _Ball(name="ball", **options)
