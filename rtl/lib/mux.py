"""Multiplexers, the number of the bit that is set, and wide gates."""

from amaranth.hdl import Cat, Const, Mux, Signal, Value

__all__ = ["all_of", "any_of", "choose", "number_of", "pick"]


def choose(m, values, index, pairs=None) -> Signal:
    """Return that of the values which has a number, in one LUT of four inputs for two values.

    A tree takes five LUTs a bit of eight values. Here each LUT of a chain has two values: if the
    one that is chosen is among them, it picks it by what comes in, and else it hands that on; the
    first one sends the index's lowest bit along, and the chosen value takes its place.
    A link is a signal, as it is used twice and Amaranth writes expressions anew at every use.

    Parameters
    ----------
    m
        The module that gets the chain.
    values
        As many of the same width as a power of two.
    index
        The number of one.
    pairs
        For each two values whether the one is among them, if that is known already. Of four values
        it should come from registers: Yosys finds the tree behind the chain where one of the two is
        the other's complement.
    """
    flat = [Value.cast(value) for value in values]
    low = index[0]
    if pairs is None:
        pairs = [index[1:] == pair for pair in range(len(flat) // 2)]
    chosen = [low] * len(flat[0])
    for mine, even, odd in zip(pairs, flat[::2], flat[1::2], strict=True):
        before, chosen = chosen, Signal(len(even), name="chosen")
        m.d.comb += chosen.eq(
            Cat(
                Mux(mine, Mux(link, right, left), link)
                for link, left, right in zip(before, even, odd, strict=True)
            )
        )
    return chosen


def pick(options: list, number: Signal):
    """Return the option with a number, by a tree over the number's bits.

    A third smaller than Amaranth's ``Array``; larger than :func:`choose`, but late bits of the
    options pass fewer LUTs.

    Parameters
    ----------
    options
        Any count; a number beyond it gives one of them.
    number
        Of bits enough to count the options.
    """
    if len(options) == 1:
        return options[0]
    bit = (len(options) - 1).bit_length() - 1
    return Mux(number[bit], pick(options[1 << bit :], number), pick(options[: 1 << bit], number))


def number_of(one_hot, bits: int | None = None) -> Cat:
    """Return the number of the one bit that is set, or 0; of it, the lowest ``bits`` bits."""
    if bits is None:
        bits = (len(one_hot) - 1).bit_length()
    return Cat(
        Cat(one_hot[i] for i in range(len(one_hot)) if i >> bit & 1).any() for bit in range(bits)
    )


def all_of(bits):
    """Return whether all bits are set, by a carry chain.

    A LUT of four inputs tests four bits. The carry leaves the chain if it passes every four.
    """
    fours = Cat(Cat(four).all() for four in _fours(bits))
    return (Cat(1, fours) + Const(1, len(fours) + 1))[-1]


def any_of(bits):
    """Return whether any bit is set, by a carry chain.

    A LUT of four inputs tests four bits. The last four with a bit set starts a carry.
    """
    fours = Cat(Cat(four).any() for four in _fours(bits))
    return (fours + Const((1 << len(fours)) - 1, len(fours)))[-1]


def _fours(bits):
    """Return the bits in groups of four."""
    bits = list(bits)
    return [bits[n : n + 4] for n in range(0, len(bits), 4)]
