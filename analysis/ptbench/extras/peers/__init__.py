"""How fast ptbench and other renderers make the same pictures, side by side in one run on one machine."""
