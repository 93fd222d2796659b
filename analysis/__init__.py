"""Reads ptbench result files and draws what they say. Knows nothing of the C++ side but the file format."""
