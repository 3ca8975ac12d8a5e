"""The rows of a code word, and the position of their half turn."""

from amaranth.hdl import Cat, Mux, Signal

__all__ = ["ShapeRows"]


class ShapeRows:
    """Decodes the four rows of an element's upper half, and the position of its lower half.

    It is combinational, and adds its logic to the module ``m``.

    **Latency**: 0. **Throughput**: one element a cycle.

    Parameters
    ----------
    m
        The module.
    element
        The element, a view of :class:`GeometryLayout`.

    Attributes
    ----------
    rows
        The ends of rows 0..3: four signals with ``first`` and ``last``, inclusive. Row 3 of a
        raised shape has its ends swapped in the code word.
    filled
        The rows with pixels: 4 bits.
    raised
        The centre lies half a line higher, in row 3. This row has then no half turn, and the half
        turns of rows 0..2 lie one line higher. It is 0 in a fraction.
    shifted
        The centre lies half a column further right, and the half turn one column. It means nothing
        in a fraction.
    """

    def __init__(self, m, element):
        scans = element.scans
        if "raised" in element.shape().members:
            self._of_plane_word(m, element)
            return
        self.rows = [Signal.like(scan, name=f"row_{k}") for k, scan in enumerate(scans)]
        self.filled = Signal(4)
        self.raised = Signal()
        self.shifted = Signal()
        middle = scans[3]
        m.d.comb += [
            *(row.eq(scan) for row, scan in zip(self.rows[:3], scans, strict=False)),
            self.raised.eq(~element.mode & middle.first[2] & ~middle.last[2]),
            self.rows[3].first.eq(Mux(self.raised, middle.last, middle.first)),
            self.rows[3].last.eq(Mux(self.raised, middle.first, middle.last)),
            self.filled.eq(Cat(scan.first <= scan.last for scan in scans)),
            self.shifted.eq(
                Mux(
                    self.raised,
                    middle.first[0] == middle.last[0],
                    ~self.filled[0] & scans[0].first[1],
                )
            ),
        ]
        with m.If(self.raised):
            m.d.comb += self.filled[3].eq(1)

    def _of_plane_word(self, m, element):
        """Take a plane word's rows as they are. It says if it is raised, and is not shifted."""
        self.rows = [Signal.like(scan, name=f"row_{k}") for k, scan in enumerate(element.scans)]
        self.filled = Signal(4)
        self.raised = Signal()
        self.shifted = Signal()
        m.d.comb += [
            *(row.eq(scan) for row, scan in zip(self.rows, element.scans, strict=True)),
            self.filled.eq(Cat(scan.first <= scan.last for scan in element.scans)),
            self.raised.eq(~element.mode & element.raised),
        ]
