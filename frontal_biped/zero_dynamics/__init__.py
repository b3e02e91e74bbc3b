"""Hybrid zero dynamics in closed form: restricted dynamics, orbit, Poincare map, energy, reversal ([O] Sec. III)."""
