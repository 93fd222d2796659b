"""Optional commands that the pages and results do not need; nothing outside of this folder imports them."""
