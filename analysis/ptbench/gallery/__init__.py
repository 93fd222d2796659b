"""The gallery: pairs of pictures to compare, on one labelled sheet."""
