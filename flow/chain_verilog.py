"""The Verilog of a chain, with one module for all of its engines."""

from __future__ import annotations

from collections.abc import Callable

from amaranth.hdl import ClockSignal, Instance, Module, ResetSignal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.rtl.chain.chain import QUEUE, Chain

from .verilog import MEANINGS, convert, describe, header

__all__ = ["Reference", "generate_chain"]


class Reference(wiring.Component):
    """An instance of a module that is written elsewhere in the same Verilog.

    Amaranth writes a module for each instance. Synthesis and simulation of a chain of eight engines
    would read the same text eight times.

    Parameters
    ----------
    module
        Name of the module.
    component
        The component of that module. The ports are the same.
    """

    def __init__(self, module: str, component: wiring.Component):
        self._module = module
        super().__init__(component.signature)

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        ports = {"i_clk": ClockSignal(), "i_rst": ResetSignal()}
        for path, member, value in self.signature.flatten(self):
            direction = "o" if member.flow is Out else "i"
            ports[f"{direction}_{'__'.join(map(str, path))}"] = Value.cast(value)
        m.submodules.part = Instance(self._module, **ports)
        return m


def generate_chain(
    config: EngineConfig = PAPER,
    engines: int = 2,
    link: str = "merge",
    name: str = "splatline",
    *,
    queue: int = QUEUE,
    progress: Share | None = None,
    around: Callable[[str, wiring.Component], wiring.Component] = lambda kind, part: part,
) -> tuple[str, dict]:
    """Return the Verilog and the description of a chain.

    Parameters
    ----------
    config, engines, link, queue
        As for :class:`Chain`.
    name
        Name of the top module; the modules of its parts are ``name_first``, ``name_engine``,
        ``name_queue`` and ``name_merger``.
    around
        A function of the kind of a part and its instance. It returns the component to use instead:
        a test may wrap the instance.
    progress
        Called now and then with the share that is done.

    Returns
    -------
    text, sidecar
        As of :func:`splatline.flow.verilog.generate`. The sidecar has ``engines`` and ``link`` too.
    """
    parts: dict[str, wiring.Component] = {}

    def refer(kind: str, make: Callable[[], wiring.Component]) -> Reference:
        if kind not in parts:
            parts[kind] = make()
        return around(kind, Reference(f"{name}_{kind}", parts[kind]))

    chain = Chain(config, engines, link, queue=queue, place=refer)
    text = header(config) + convert(chain, name)
    for kind, part in parts.items():
        # The other parts are small.
        text += convert(part, f"{name}_{kind}", progress if kind == "engine" else None)
    meanings = MEANINGS | {
        f"codewords_{n}": f"code words of engine {n}'s part of the frame, sorted by line"
        for n in range(engines)
    }
    sidecar = describe(chain, name, meanings)
    return text, sidecar | {"engines": engines, "link": link, "queue": queue}
