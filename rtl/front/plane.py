"""The plane of an element: its slopes in full, and what lies before its first pixel."""

from amaranth.hdl import Signal

from splatline.contract.config import EngineConfig
from splatline.contract.plane import SHIFTS
from splatline.rtl.layouts import PlaneLayout

__all__ = ["plane_of"]


def plane_of(m, element, enable, config: EngineConfig):
    """Return a register of the plane of an offered element, which follows while ``enable`` is high.

    It takes multipliers, of which an engine has most left: a slope times a power of two, and times
    the block's column in its window word or its line modulo four, shifted alike.

    **Latency**: 1 cycle. **Throughput**: one element a cycle.

    Parameters
    ----------
    m
        The module that gets the logic.
    element
        The element, a view of :class:`ElementLayout`.
    enable
        The register follows.
    config
        The engine.
    """
    plane = Signal(PlaneLayout(config), name="plane", reset_less=True)
    one, column, line = (
        Signal(SHIFTS[-1] + bits, name=f"{name}_scaled")
        for name, bits in (("one", 1), ("column", config.pixel_bits), ("line", 2))
    )
    with m.Switch(element.scale):
        for number, shift in enumerate(SHIFTS):
            with m.Case(number):
                m.d.comb += [
                    one.eq(1 << shift),
                    column.eq(element.x[: config.pixel_bits] << shift),
                    line.eq(element.line_modulo_4 << shift),
                ]
    with m.If(enable):
        m.d.sync += [
            plane.across.eq(element.slope_x * one),
            plane.down.eq(element.slope_y * one),
            plane.before.eq(element.slope_x * column),
            plane.above.eq(element.slope_y * line),
        ]
    return plane
