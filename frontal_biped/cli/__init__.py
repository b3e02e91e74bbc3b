"""Command line: parse, call one function, print. No mathematics.

One file a command, each with its arguments, its example and what it runs. What a command needs is imported when it
runs, so that ``--help`` does not wait for Pinocchio.
"""

from frontal_biped.cli.main import main

__all__ = ["main"]
