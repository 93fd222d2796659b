"""What stiff cases came out as: layout and words of a stability file."""
