"""What a page may have as a source, a kind of file each: whatever lies here is found (findings/source.py)."""
