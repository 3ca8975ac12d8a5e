"""What all parts agree on, in plain Python: configuration, code word, frame, raster, registers.

It imports nothing of ours. Start with ``config``; ``docs/contract.md`` explains each field.
"""
