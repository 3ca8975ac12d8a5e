"""What the tests reach: lines of Python, and lines and toggles of the generated Verilog.

Start with ``__main__``.
"""
