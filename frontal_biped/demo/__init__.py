"""The demonstration: design, certify, simulate, page and figures in one folder."""

from frontal_biped.demo.demo import make_demo

__all__ = [
    "make_demo",
]
