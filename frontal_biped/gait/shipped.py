"""The gaits and the gait specifications that come with the package, by name."""

import difflib
from pathlib import Path

from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait.specification import GaitSpecification, read_specification
from frontal_biped.model.catalogue import models_dir, robot_names

GAIT_ENDING = ".gait.json"
"""What follows the name of its robot in the name of a packaged gait's file."""


def gait_names() -> list[str]:
    """Names of the packaged gaits: those of their robots."""
    return sorted(path.name.removesuffix(GAIT_ENDING) for path in models_dir().glob(f"*{GAIT_ENDING}"))


def gait_path(name_or_path: str | Path) -> Path:
    """The gait file of what `load_gait` is given: a file, or else the name of a packaged gait or of its file.

    Raises:
        GaitFileError: it looks like a name, and there is no such packaged gait.
    """
    path = Path(name_or_path)
    if path.is_file() or path.name != str(path):
        return path
    packaged = models_dir() / f"{path.name.removesuffix(GAIT_ENDING)}{GAIT_ENDING}"
    if packaged.is_file():
        return packaged
    names = gait_names()
    if path.suffix or (path.is_dir() and path.name not in robot_names()):
        return path  # there is no such file, which is told where it is read
    if path.name in robot_names():
        remedy = f"the robot comes without one; design it with `frontal-biped design --robot {path.name}`"
    elif close := difflib.get_close_matches(path.name, names, n=1):
        remedy = f"did you mean {close[0]!r}?"
    else:
        remedy = f"name a gait file (.json), or one of {', '.join(names)}"
    raise GaitFileError(f"no gait {path.name!r}; {remedy}")


def specifications_dir() -> Path:
    """Folder of the packaged specifications, beside the packaged robots."""
    return models_dir() / "specifications"


def specification_names() -> list[str]:
    """Names of the packaged specifications."""
    return sorted(path.stem for path in specifications_dir().glob("*.toml"))


def load_specification(name_or_path: str | Path) -> GaitSpecification:
    """The specification in a file, or else a packaged one by its name or that of its file.

    Raises:
        SpecificationError: there is none of that name, or the file cannot be used.
    """
    text = str(name_or_path)
    names = specification_names()
    if Path(text).is_file():
        return read_specification(text)
    if Path(text).suffix == ".toml":
        packaged = Path(text).name == text and Path(text).stem in names
        return read_specification(specifications_dir() / text if packaged else text)
    if text not in names:
        close = difflib.get_close_matches(text, names, n=1)
        remedy = f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}; or name a .toml file"
        raise SpecificationError(f"no specification {text!r}; {remedy}")
    return read_specification(specifications_dir() / f"{text}.toml")
