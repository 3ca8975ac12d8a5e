"""``splatline bench engine``: clock cycles of frames, beside the lower bound."""
