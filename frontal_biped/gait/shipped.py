"""The gait specifications that come with the package, by name."""

import difflib
from pathlib import Path

from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.specification import GaitSpecification, read_specification
from frontal_biped.model.catalogue import models_dir


def specifications_dir() -> Path:
    """Folder of the packaged specifications, beside the packaged robots."""
    return models_dir() / "specifications"


def specification_names() -> list[str]:
    """Names of the packaged specifications."""
    return sorted(path.stem for path in specifications_dir().glob("*.toml"))


def load_specification(name_or_path: str | Path) -> GaitSpecification:
    """A packaged specification by name, or the one in a file.

    Raises:
        SpecificationError: there is none of that name, or the file cannot be used.
    """
    text = str(name_or_path)
    if Path(text).suffix == ".toml" or Path(text).is_file():
        return read_specification(Path(text))
    names = specification_names()
    if text not in names:
        close = difflib.get_close_matches(text, names, n=1)
        remedy = f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}; or name a .toml file"
        raise SpecificationError(f"no specification {text!r}; {remedy}")
    return read_specification(specifications_dir() / f"{text}.toml")
