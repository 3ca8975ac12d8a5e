"""What commands print: tables, figures, progress.

It imports ``contract``. Start with ``tables``.
"""
