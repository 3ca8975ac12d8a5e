"""Ways to break a circuit on purpose: in its Verilog, or in the source of a component."""

import inspect
import linecache
import re
import textwrap

__all__ = ["LANE_WRITES", "fault", "rewrite"]

LANE_WRITES = "{ taken[0] | taken[1], 11'h0 }"
"""In place of a lane's comparison: it writes whatever it is asked to draw or to clear."""


def fault(module, signal, value):
    """An edit that fixes a signal of a module's Verilog at a value."""

    def edit(text):
        begin = re.search(rf"^module \\?{re.escape(module)} ?\(", text, re.MULTILINE).start()
        end = text.index("endmodule", begin)
        body, count = re.subn(
            rf"^(  assign \\?{re.escape(signal)} ?=)[^;]*;",
            rf"\g<1> {value};",
            text[begin:end],
            flags=re.MULTILINE,
        )
        assert count == 1, f"{module} has no {signal} to break"
        return text[:begin] + body + text[end:]

    return edit


def rewrite(monkeypatch, part, method, pattern, replacement):
    """Break a component where it is written, for what has no name in the Verilog.

    What is broken can be broken again in another place.
    """
    source = textwrap.dedent(inspect.getsource(getattr(part, method)))
    broken, count = re.subn(pattern, replacement, source)
    assert count == 1, f"{part.__name__}.{method} has {count} places to break"
    scope = dict(vars(inspect.getmodule(part)))
    name = f"<{part.__name__}.{method} with {replacement!r}>"
    linecache.cache[name] = len(broken), None, broken.splitlines(keepends=True), name
    exec(compile(broken, name, "exec"), scope)
    monkeypatch.setattr(part, method, scope[method])
