"""Ways to break a circuit on purpose: in its Verilog, or in the source of a component."""

import inspect
import linecache
import re
import textwrap

__all__ = ["LANE_WRITES", "fault", "rewrite", "switched", "switched_source"]

LANE_WRITES = "{ taken[0] | taken[1], 11'h0 }"
"""In place of a lane's comparison: it writes whatever it is asked to draw or to clear."""


def fault(module, signal, value):
    """An edit that fixes a signal of a module's Verilog at a value."""
    return lambda text: _assign(text, module, signal, lambda _: value)


def _assign(text, module, signal, change):
    """Change what a signal of a module is assigned; ``top.part`` is the module ``top__part``."""
    module = module.replace(".", "__")
    begin = re.search(rf"^module \\?{re.escape(module)} ?\(", text, re.MULTILINE).start()
    end = text.index("endmodule", begin)
    body, count = re.subn(
        rf"^(  assign \\?{re.escape(signal)} ?=)([^;]*);",
        # An escaped name ends at a space.
        lambda found: f"{found[1]} {change(found[2].strip())} ;",
        text[begin:end],
        flags=re.MULTILINE,
    )
    assert count == 1, f"{module} has no {signal} to break"
    return text[:begin] + body + text[end:]


def rewrite(monkeypatch, part, method, pattern, replacement):
    """Break a component where it is written, for what has no name in the Verilog.

    What is broken can be broken again in another place.
    """
    source = textwrap.dedent(inspect.getsource(getattr(part, method)))
    broken, count = re.subn(pattern, replacement, source)
    assert count == 1, f"{part.__name__}.{method} has {count} places to break"
    _replace(monkeypatch, part, method, broken, repr(replacement))


def _replace(monkeypatch, part, method, source, what):
    """Put a method with another source into a component; ``what`` is wrong with it."""
    scope = dict(vars(inspect.getmodule(part)))
    name = f"<{part.__name__}.{method} with {what}>"
    linecache.cache[name] = len(source), None, source.splitlines(keepends=True), name
    exec(compile(source, name, "exec"), scope)
    monkeypatch.setattr(part, method, scope[method])


def switched(top, faults):
    """An edit that plants faults, as arguments of :func:`fault`, and ``+fault=N`` chooses the Nth.

    One build then serves them all, and with ``+fault=0`` none is there.
    """

    def edit(text):
        for number, (module, signal, value) in enumerate(faults, 1):
            chosen = f"{top}.planted == {number} ? {value}"
            text = _assign(text, module, signal, lambda old, new=chosen: f"{new} : {old}")
        head = re.search(rf"^module \\?{re.escape(top)} ?\(.*?;", text, re.MULTILINE | re.DOTALL)
        choice = 'integer planted = 0; initial if ($value$plusargs("fault=%d", planted)) ;'
        return f"{text[: head.end()]}\n  {choice}\n{text[head.end() :]}"

    return edit


def switched_source(monkeypatch, part, faults):
    """Plant faults where a component is written; return an edit of its Verilog that is yet to do.

    Then ``+fault=N`` chooses the Nth, and with ``+fault=0`` none is there. Each is an expression of
    ``elaborate``, or of another method that it names, as a pattern, and what it is instead.
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
        _replace(monkeypatch, part, name, source, "faults")

    def edit(text):
        choice = r'\1 initial if (!$value$plusargs("fault=%d", planted)) planted = 0;'
        text, count = re.subn(r"(reg \[7:0\] planted = 8'h00;)", choice, text)
        assert count == 1
        return text

    return edit
