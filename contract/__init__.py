"""The contract of all parts, in plain Python: configuration, code word, frame, raster, registers.

Errors, progress, and files that are written whole or not at all, are here too. It imports nothing
of ours. Start with ``config``; ``docs/contract.md`` explains each field.
"""
