"""The command line: thin, and the one place that knows host, hardware and simulation."""
