"""Points that no test reaches, and why."""

from dataclasses import dataclass

__all__ = ["EXCUSES", "Excuse"]


@dataclass(frozen=True)
class Excuse:
    """Why points are not reached.

    Parameters
    ----------
    points
        A pattern of whole points, as ``verilog`` names them.
    reason
        Why not.
    """

    points: str
    reason: str


EXCUSES: list[Excuse] = []
