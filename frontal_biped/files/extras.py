"""What to do about a package that is not installed."""

import shlex
import sys

from frontal_biped.exceptions import MissingExtraError


def pip_install(requirement: str) -> str:
    """The command line that installs a package for the interpreter that runs."""
    return f"{shlex.quote(sys.executable)} -m pip install {shlex.quote(requirement)}"


def missing_extra(what: str, extra: str) -> MissingExtraError:
    """The complaint about an optional dependency, with the remedy.

    Args:
        what: needs what, for example "figures need Matplotlib".
        extra: that brings it.
    """
    return MissingExtraError(f"{what}: {pip_install(f'frontal-biped[{extra}]')}")
