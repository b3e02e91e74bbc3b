"""A gait as it is given to a function: itself, a design's result, the name of a packaged one, or a file."""

from pathlib import Path
from typing import Protocol

from frontal_biped.exceptions import DesignFailedError, GaitFileError
from frontal_biped.gait.file import load_gait
from frontal_biped.gait.gait import Gait


class Designed(Protocol):
    """What a design returns: `DesignResult`."""

    @property
    def gait(self) -> Gait | None:
        """The gait, or None where none was found."""

    @property
    def message(self) -> str:
        """What was reached, or why there is none; one line."""


GaitLike = Gait | Designed | str | Path
"""What `gait_of` takes."""


def gait_of(gait: GaitLike) -> Gait:
    """The gait itself; of a design's result its gait; of a name or path what `load_gait` reads.

    Raises:
        DesignFailedError: the design found no gait.
        GaitFileError: there is none of that name, the file cannot be read, or what is given is none of these; one line.
    """
    if isinstance(gait, Gait):
        return gait
    if isinstance(gait, str | Path):
        return load_gait(gait)
    if not hasattr(gait, "gait") or not isinstance(gait.gait, Gait | None):
        raise GaitFileError(
            f"gait = {type(gait).__name__}: no gait; give one, the result of a design, the name of a packaged gait or"
            " the path of a gait file"
        )
    if gait.gait is None:
        raise DesignFailedError(f"the design found no gait: {getattr(gait, 'message', 'it does not say why')}")
    return gait.gait
