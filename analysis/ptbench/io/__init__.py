"""Files: what ptbench wrote is read and validated as typed objects; output files are written atomically."""
