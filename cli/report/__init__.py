"""Output of commands: tables and progress.

It imports ``contract``. Start with ``tables``.
"""
