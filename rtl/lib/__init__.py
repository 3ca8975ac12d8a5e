"""Small parts that several components use: multiplexers, wide gates, a FIFO.

It imports ``contract`` and ``rtl.layouts``. Start with ``mux``.
"""
