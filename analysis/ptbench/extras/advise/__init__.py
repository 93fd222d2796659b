"""Which choices to take for a user's own scene, from what was measured, with what it is known to be worth."""
