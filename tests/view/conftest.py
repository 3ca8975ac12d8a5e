"""A session that looks at a ball."""

import pytest

from splatline.view.session import Session

from .views import SIZE, Clock, ball, event, last_picture


@pytest.fixture(scope="module")
def live():
    return ball().read(None)


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def session(live, clock):
    """A session that shows the refined first picture."""
    session = Session(ball(), clock=clock)
    session.queue(event("resize", width=SIZE[0], height=SIZE[1]))
    session.take(live, None)
    last_picture(session)
    return session
