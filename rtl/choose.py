"""A multiplexer in fewer LUTs."""

from amaranth.hdl import Cat, Mux, Value

__all__ = ["choose"]


def choose(values, index) -> Cat:
    """Return that of the values which has a number, in one LUT of four inputs for two values.

    A tree takes five LUTs a bit of eight values. Here each LUT of a chain has two values: if the
    one that is chosen is among them, it picks it by what comes in, and else it hands that on; the
    first one sends the index's lowest bit along, and the chosen value takes its place.

    Parameters
    ----------
    values
        Two, four or eight of the same width.
    index
        The number of one.
    """
    flat = [Value.cast(value) for value in values]
    low, pairs = index[0], [index[1:] == pair for pair in range(len(flat) // 2)]
    bits = []
    for bit in range(len(flat[0])):
        chosen = low
        for pair, mine in enumerate(pairs):
            even, odd = flat[2 * pair][bit], flat[2 * pair + 1][bit]
            chosen = Mux(mine, Mux(chosen, odd, even), chosen)
        bits.append(chosen)
    return Cat(bits)
