"""The host: from a point cloud to the code words that an engine draws."""
