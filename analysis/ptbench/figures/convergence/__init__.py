"""The figures of a study of convergence."""
