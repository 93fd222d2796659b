"""Pairs of pictures on one labelled sheet."""
