"""The hardware: a rendering engine for oriented points, written in Amaranth.

Code words pass ``shapes`` (if there is a shape ROM), ``front``, and a window of ``tiles`` or
``blocks``. It imports ``contract``. Start with ``engine``.
"""
