"""Wide gates on a carry chain: a LUT of four inputs for four bits, and none to join them."""

from amaranth.hdl import Cat, Const

__all__ = ["all_of", "any_of"]


def all_of(bits):
    """Return whether all bits are set: a carry that passes all fours."""
    fours = Cat(Cat(four).all() for four in _fours(bits))
    return (Cat(1, fours) + Const(1, len(fours) + 1))[-1]


def any_of(bits):
    """Return whether a bit is set: a carry from the last four that has one."""
    fours = Cat(Cat(four).any() for four in _fours(bits))
    return (fours + Const((1 << len(fours)) - 1, len(fours)))[-1]


def _fours(bits):
    bits = list(bits)
    return [bits[n : n + 4] for n in range(0, len(bits), 4)]
