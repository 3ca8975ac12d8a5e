"""What the screen of a small simulated board shows."""

import numpy as np

from splatline.boards.simulated import SMALL
from splatline.sim.dvi.receiver import receive

from .board_frames import BACKGROUND

__all__ = ["BIT", "CHARACTERS", "cut_off", "seconds", "watch", "which"]

CHARACTERS = (SMALL["h_active"] + SMALL["h_blanking"]) * (SMALL["v_active"] + SMALL["v_blanking"])
BIT = 8
"""ns of a bit on the pins: half the rate of a real one, so that the link takes fewer of them."""


def seconds(refreshes, bit=BIT):
    """Return how long so many refreshes and a little more take."""
    return (refreshes + 0.02) * CHARACTERS * 10 * bit * 1e-9


def watch(simulated, refreshes, bit=BIT):
    """Return what the screen shows in so many whole refreshes."""
    return receive(simulated.watch(seconds(refreshes + 1, bit))).pictures[:refreshes]


def which(shown, pictures):
    """Return the number of the picture that each refresh shows, pixel by pixel; -1: none."""
    return [
        next((n for n, picture in enumerate(pictures) if (refresh == picture).all()), -1)
        for refresh in shown
    ]


def cut_off(refresh, pictures):
    """Return whether a refresh is the beginning of a picture, and then background alone."""
    pixels = refresh.reshape(-1, 3)
    for picture in pictures:
        differs = (pixels != picture.reshape(-1, 3)).any(axis=1)
        if not differs.any() or (pixels[int(np.argmax(differs)) :] == BACKGROUND).all():
            return True
    return False
