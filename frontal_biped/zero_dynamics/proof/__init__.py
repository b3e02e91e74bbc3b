"""Proofs in ball arithmetic of what the closed form measures: extra ``proof``."""
