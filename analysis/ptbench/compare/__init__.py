"""Result files of two commits, two machines or many GPUs, held against the first of them."""
