"""A gait as it is given to a function: itself, a design's result, the name of a packaged one, or a file."""

from pathlib import Path
from typing import Protocol

from frontal_biped.exceptions import DesignFailedError, GaitFileError
from frontal_biped.gait.file import load_any_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.sideways import AnyGait, SidewaysGait
from frontal_biped.gait.support_gait import SupportGait


class Designed(Protocol):
    """What a design returns: `DesignResult`, `SidewaysResult`."""

    @property
    def gait(self) -> AnyGait | None:
        """The gait, or None where none was found."""

    @property
    def message(self) -> str:
        """What was reached, or why there is none; one line."""


GaitLike = AnyGait | Designed | str | Path
"""What `gait_of` and `any_gait_of` take."""


def gait_of(gait: GaitLike) -> Gait:
    """The gait itself; of a design's result its gait; of a name or path what `load_gait` reads.

    Raises:
        DesignFailedError: the design found no gait.
        GaitFileError: there is none of that name, the file cannot be read, or what is given is none of these or travels
            sideways; one line.
    """
    found = any_gait_of(gait)
    if isinstance(found, SidewaysGait):
        raise GaitFileError(
            f"gait = {found!r}: two steps in turn; simulate or analyze take them, for this give a gait on the spot,"
            " designed without travel"
        )
    return found


def any_gait_of(gait: GaitLike) -> AnyGait:
    """As `gait_of`, for gaits that travel sideways as well.

    Raises:
        DesignFailedError: the design found no gait.
        GaitFileError: there is none of that name, the file cannot be read, or what is given is none of these; one line.
    """
    if isinstance(gait, Gait | SidewaysGait):
        return gait
    if isinstance(gait, str | Path):
        return load_any_gait(gait)
    if isinstance(gait, SupportGait):
        raise GaitFileError(
            f"gait = {gait!r}: has a finite double support; `stand_walk_stand` walks it, `certify_support_gait`"
            " analyses it; for this give one designed without double_support"
        )
    if not hasattr(gait, "gait") or not isinstance(gait.gait, Gait | SidewaysGait | None):
        raise GaitFileError(
            f"gait = {type(gait).__name__}: no gait; give one, the result of a design, the name of a packaged gait or"
            " the path of a gait file"
        )
    if gait.gait is None:
        raise DesignFailedError(f"the design found no gait: {getattr(gait, 'message', 'it does not say why')}")
    return gait.gait
