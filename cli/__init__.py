"""The command line. It imports all rooms. Start with ``main``."""
