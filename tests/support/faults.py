"""Planted faults: in the Verilog, or in the source of a component."""

import inspect
import linecache
import re
import textwrap

from splatline.sim.cosim import kept_verilog

__all__ = [
    "LANE_WRITES",
    "chosen",
    "fault",
    "replace_method",
    "rewrite",
    "switched",
    "switched_source",
]

LANE_WRITES = "{ taken[0] | taken[1], 11'h0 }"
"""In place of a lane's comparison: every draw and every clear is written."""


def fault(module, signal, value):
    """Return an edit of Verilog that assigns a value to a module's signal."""
    return lambda text: _assign(text, module, signal, lambda _: value)


def _assign(text, module, signal, change):
    """Change the assignment of a module's signal; ``top.part`` is the module ``top__part``."""
    module = module.replace(".", "__")
    begin = re.search(rf"^module \\?{re.escape(module)} ?\(", text, re.MULTILINE).start()
    end = text.index("endmodule", begin)
    body, count = re.subn(
        rf"^( *assign \\?{re.escape(signal)} ?=)([^;]*);",
        # An escaped name ends at a space.
        lambda found: f"{found[1]} {change(found[2].strip())} ;",
        text[begin:end],
        flags=re.MULTILINE,
    )
    assert count == 1, f"{module} has no {signal} to break"
    return text[:begin] + body + text[end:]


def rewrite(monkeypatch, part, method, pattern, replacement):
    """Rewrite a component's source, for faults in expressions without a name in the Verilog.

    ``part`` is a class with a method, or a module with a function that it defines or imports. The
    pattern must match exactly once in the source. A rewritten component can be rewritten again.
    """
    source = textwrap.dedent(inspect.getsource(getattr(part, method)))
    broken, count = re.subn(pattern, replacement, source)
    assert count == 1, f"{part.__name__}.{method} has {count} places to break"
    replace_method(monkeypatch, part, method, broken, repr(replacement))


def replace_method(monkeypatch, part, method, source, what, **names):
    """Replace a component's method by other source, which may need names; ``what``: the fault's."""
    scope = {**vars(inspect.getmodule(getattr(part, method))), **names}
    name = f"<{part.__name__}.{method} with {what}>"
    linecache.cache[name] = len(source), None, source.splitlines(keepends=True), name
    exec(compile(source, name, "exec"), scope)
    monkeypatch.setattr(part, method, scope[method])
    # What is written of this hardware is not kept, nor is what was kept taken for it.
    monkeypatch.setattr(kept_verilog, "_digest_of_sources", object)


def chosen(faults, first):
    """Return an edit that plants faults, each a signal of ``dut`` and a value.

    The port ``fault`` of ``planted.build`` selects one by its number, counted from ``first``.
    """

    def edit(text):
        for number, (signal, value) in enumerate(faults, first):
            condition = f"dut.fault == {number} ? {value}"
            text = _assign(text, "dut", signal, lambda old, new=condition: f"{new} : {old}")
        return text

    return edit


def switched(top, faults, first=1):
    """Return an edit that plants several faults, each the arguments of :func:`fault`.

    One build has them all: ``+fault=N`` selects the one of that number, and ``+fault=0`` none.
    """

    def edit(text):
        for number, (module, signal, value) in enumerate(faults, first):
            chosen = f"{top}.planted_here == {number} ? {value}"
            text = _assign(text, module, signal, lambda old, new=chosen: f"{new} : {old}")
        head = re.search(rf"^module \\?{re.escape(top)} ?\(.*?;", text, re.MULTILINE | re.DOTALL)
        choice = "integer planted_here = 0; "
        choice += 'initial if ($value$plusargs("fault=%d", planted_here)) ;'
        return f"{text[: head.end()]}\n  {choice}\n{text[head.end() :]}"

    return edit


def switched_source(monkeypatch, part, faults):
    """Plant several faults in a component's source; return an edit that its Verilog needs.

    Each fault is a pattern of an expression, the expression instead, and the method if it is not
    ``elaborate``. ``+fault=N`` selects the Nth, and ``+fault=0`` none.
    """
    sources = {"elaborate": textwrap.dedent(inspect.getsource(part.elaborate))}
    for number, (pattern, value, *method) in enumerate(faults, 1):
        (name,) = method or ["elaborate"]
        source = sources.get(name) or textwrap.dedent(inspect.getsource(getattr(part, name)))
        chosen = rf"Mux(self.planted == {number}, {value}, \g<0>)"
        sources[name], count = re.subn(pattern, chosen, source)
        assert count == 1, f"{part.__name__} has {count} places to break by {pattern}"
    # A register that nothing writes, so that it stays in the Verilog.
    head = "m = Module(); self.planted = planted = Signal(8, reset_less=True)"
    head += "; m.d.sync += planted.eq(planted)"
    sources["elaborate"] = sources["elaborate"].replace("m = Module()", head, 1)
    for name, source in sources.items():
        replace_method(monkeypatch, part, name, source, "faults")

    def edit(text):
        choice = r'\1 initial if (!$value$plusargs("fault=%d", planted)) planted = 0;'
        text, count = re.subn(r"(reg \[7:0\] planted = 8'h00;)", choice, text)
        assert count == 1
        return text

    return edit
