"""A cloud that turns in a Jupyter notebook.

It imports ``contract``, ``host``, ``view``, and ``anywidget`` where it is installed. Start with
``show``.
"""
