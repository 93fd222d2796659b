"""What a study of a result file asks and what it measured, before anything is drawn or written of it."""
