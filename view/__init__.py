"""Pictures that move: a live view in the browser, a widget in a notebook, films.

It imports ``contract``, ``host``, ``sim`` (golden, cycles, reference), ``plots`` and the figures of
``flow``. Start with ``draw``: a live cloud, a camera and settings in, a picture out.
"""
