"""Names of files that can be printed, and written into other files."""

from pathlib import Path

from frontal_biped.exceptions import FrontalBipedError


def require_utf8_name(path: Path | str, error: type[FrontalBipedError]) -> None:
    """Raise ``error``, in one line, where the name of a file or of a folder above it is not UTF-8.

    Linux allows any bytes; archives from elsewhere bring such names along.
    """
    place = path.absolute() if isinstance(path, Path) else path
    try:
        str(place).encode("utf-8")
    except UnicodeEncodeError:
        shown = str(path).encode("utf-8", errors="replace").decode("utf-8")
        raise error(f"{shown}: the name of this file or of a folder above it is not UTF-8; rename it") from None
