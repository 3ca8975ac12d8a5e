"""Output of commands: tables and progress.

It imports ``contract``, ``host`` and, for types, ``cli.options``. Start with ``tables``.
"""
