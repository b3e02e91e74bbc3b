"""Which software made a result."""

import platform
from importlib.metadata import PackageNotFoundError, version

from frontal_biped.version import __version__


def software_versions() -> dict[str, str]:
    """Versions of everything a gait depends on."""
    versions = {"frontal-biped": __version__, "python": platform.python_version()}
    for package in ("pin", "numpy", "scipy", "proxsuite"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "unknown"
    return versions
