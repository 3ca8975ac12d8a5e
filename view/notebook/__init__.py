"""A cloud that turns in a Jupyter notebook.

It imports what ``view`` does, and ``anywidget`` where it is installed. Start with ``show``.
"""
