"""What tests of the live view share."""

from splatline.view.events import check_event
from splatline.view.session import Picture

__all__ = ["event", "last_picture"]


def event(kind, **values):
    """Return an event as the page would send it."""
    return check_event({"type": kind, **values})


def pictures(outputs):
    """Return the pictures among some outputs."""
    return [output for output in outputs if isinstance(output, Picture)]


def last_picture(session):
    """Let a session work until nothing is due at once; return its last picture."""
    shown = []
    while session.due() == 0.0:
        shown += pictures(session.work())
    return shown[-1]
