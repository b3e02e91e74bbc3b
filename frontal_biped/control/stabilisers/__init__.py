"""Stabilisers: which virtual constraints the next phase follows, given how it begins."""
