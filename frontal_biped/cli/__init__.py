"""Command line: parse, call one function, print. No mathematics."""

from frontal_biped.cli.main import main

__all__ = ["main"]
