"""The hardware: a rendering engine for oriented points, written in Amaranth."""
