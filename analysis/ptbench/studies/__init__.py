"""The question of a study in a result file and its measurements, before anything is drawn or written."""
