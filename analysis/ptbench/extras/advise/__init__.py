"""Advice on which variant to choose for a user's scene, from measurements, with how reliable such advice is."""
