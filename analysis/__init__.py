"""The name under which `ptbench` was run before; `__main__.py` goes on taking its calls for one release."""
