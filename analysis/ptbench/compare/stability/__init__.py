"""Files of `ptbench stability`, held against the first of them."""
