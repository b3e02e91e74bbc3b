"""Which software made a result."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from frontal_biped.version import __version__


def software_versions() -> dict[str, str]:
    """Versions of everything a gait depends on."""
    versions = {"frontal-biped": __version__, "python": platform.python_version()}
    return versions | {package: _installed(package) for package in ("pin", "numpy", "scipy", "proxsuite")}


@cache  # found by reading the package's files
def _installed(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
