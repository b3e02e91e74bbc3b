"""Frontal-plane bipedal zero dynamics."""
