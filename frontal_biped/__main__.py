"""`python -m frontal_biped`."""

import sys


def run() -> int:
    """The command line; Ctrl+C while it is still being imported is no traceback either."""
    try:
        from frontal_biped.cli import main
    except KeyboardInterrupt:
        sys.stderr.write("frontal-biped: error: interrupted before it began\n")
        return 130
    return main()


if __name__ == "__main__":
    sys.exit(run())
