"""Find and load robots: by the name of a packaged description, or by the path of a description or URDF."""

import difflib
from importlib.resources import files
from pathlib import Path

from frontal_biped.exceptions import RobotError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.robot import Robot
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.urdf.description import read_description

DEFAULT_ROBOT = "frontal_biped"

RobotLike = FrontalBiped | Robot | FreeRobot | str | Path
"""What `biped_of` takes."""


def models_dir() -> Path:
    """Folder of the packaged robots: inside the installed wheel, or beside the package in a working copy."""
    installed = Path(str(files("frontal_biped"))) / "models"
    working_copy = Path(__file__).resolve().parents[2] / "models"
    for folder in (installed, working_copy):
        if folder.is_dir():
            return folder
    raise RobotError(f"{installed}: the packaged robots are missing; reinstall frontal-biped")


def robot_names() -> list[str]:
    """Names of the packaged robots."""
    return sorted(path.stem for path in models_dir().glob("*.toml"))


def is_packaged(description: Path) -> bool:
    """Is a description one of those that come with the package?"""
    return description.parent.resolve() == models_dir().resolve()


def is_robot(path: Path) -> bool:
    """Is it a robot, by name or file, rather than a gait or a run?"""
    return path.suffix in (".toml", ".urdf") or (not path.is_file() and str(path) in robot_names())


def load_robot(name_or_path: str | Path = DEFAULT_ROBOT) -> FrontalBiped:
    """Load a robot, seen in its frontal plane, and check it against HR1 to HR5.

    Args:
        name_or_path: a name from `robot_names`, a description (``.toml``), or a URDF with a description of the
            same name beside it.

    Returns:
        The robot in stance coordinates.

    Raises:
        RobotError: nothing is found there, or the files cannot be used; `HypothesisError` names the hypothesis.
    """
    return FrontalBiped(load_whole_robot(name_or_path))


def biped_of(robot: RobotLike) -> FrontalBiped:
    """A robot as it is given to a function, seen in its frontal plane: any view of it, its name, or the path of a file.

    Raises:
        RobotError: there is none of that name, its files cannot be used, or what is given is none of these; one line.
    """
    return robot if isinstance(robot, FrontalBiped) else FrontalBiped(whole_of(robot))


def whole_of(robot: RobotLike) -> Robot:
    """The whole robot of what `biped_of` takes.

    Raises:
        RobotError: as `biped_of`; the frontal plane asks nothing of it yet.
    """
    if isinstance(robot, str | Path):
        return load_whole_robot(robot)
    if isinstance(robot, Robot):
        return robot
    if isinstance(robot, FrontalBiped | FreeRobot):
        return robot.robot
    raise RobotError(
        f"robot = {type(robot).__name__}: no robot; give one, the name of a packaged robot, or the path of a"
        " description (.toml) or URDF (.urdf)"
    )


def load_whole_robot(name_or_path: str | Path = DEFAULT_ROBOT) -> Robot:
    """Load a robot with every joint, in space; the frontal plane asks nothing of it yet.

    Args:
        name_or_path: as for `load_robot`.

    Raises:
        RobotError: nothing is found there, or the files cannot be used.
    """
    return Robot.of(read_description(description_path(name_or_path)))


def description_path(name_or_path: str | Path) -> Path:
    """The description file of what `load_robot` is given.

    Raises:
        RobotError: there is none.
    """
    text = str(name_or_path)
    packaged = models_dir() / f"{text}.toml"
    path = Path(text)
    if path.suffix == ".urdf":
        beside = path.with_suffix(".toml")
        if not path.is_file():
            raise RobotError(f"{path}: no such URDF file; check the path, or see `frontal-biped robots`")
        if not beside.is_file():
            raise RobotError(
                f"{path}: needs a description {beside.name} beside it that names its roll joints and soles; make one"
                f" with `frontal-biped robots --describe {path} -o {beside}`"
            )
        return beside
    if path.suffix == ".toml":
        return path
    if "/" not in text and packaged.is_file():
        return packaged
    if path.exists():
        raise RobotError(f"{path}: neither a description (.toml) nor a URDF (.urdf); name one of these")
    close = difflib.get_close_matches(text, robot_names(), n=1)
    remedy = f"did you mean {close[0]!r}?" if close else f"known robots: {', '.join(robot_names())}"
    raise RobotError(f"no robot {text!r}; {remedy}")
