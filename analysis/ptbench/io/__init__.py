"""Files: what ptbench wrote is read, checked and told as objects; what is written is written whole."""
