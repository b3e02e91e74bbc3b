"""Which software made a result."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from frontal_biped.version import __version__


def software_versions() -> dict[str, str]:
    """Versions of everything a gait depends on."""
    packages = {package: _version(package) for package in ("pin", "numpy", "scipy", "proxsuite")}
    return {"frontal-biped": __version__, "python": platform.python_version(), **packages}


@cache
def _version(package: str) -> str:
    """Looked up once a process: it reads the package's folder, which takes as long as a tenth of a short design."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
