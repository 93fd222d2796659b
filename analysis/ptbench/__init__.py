"""Reads ptbench result files and draws what they say. Knows nothing of the C++ side but the file format."""

__version__ = "0.1.0"  # the program's, CMakeLists.txt
