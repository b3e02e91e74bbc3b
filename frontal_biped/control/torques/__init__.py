"""Torques of one tick: input-output linearisation, and the quadratic program that keeps its limits."""
