"""``splatline bench large``: clouds larger than the memory."""
