"""Result files as tidy data: one row per observation, one column per variable."""
