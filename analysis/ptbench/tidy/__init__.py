"""Result files as tidy data: one row an observation, one column a variable."""
