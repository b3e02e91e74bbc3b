"""Numerical methods without a robot in them: quadrature, Chebyshev fits, least distance, quadratic programs."""
