"""Prepare a walk in space: whatever a robot still lacks for it, description, bent knees or gait, is made and kept.

    a name              its knees are bent: a packaged robot of the same URDF whose knees are bent takes its place, or
                        one is made of it
    a description       likewise, beside it
    a URDF              the description beside it, or one that is made: legs found, knees bent, soles measured
    a gait              the packaged one, the one kept in the folder, or one designed and kept there

What was made is found again, and nothing is written over.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from frontal_biped.design.optimise import optimise_gait
from frontal_biped.exceptions import DesignFailedError, GaitFileError, RobotError
from frontal_biped.files.atomic import require_folder, write_text
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import default_specification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import description_path, load_robot, models_dir, robot_names
from frontal_biped.model.urdf.bent_posture import room_for_steps
from frontal_biped.model.urdf.bent_proposal import leg_length, propose_bent_posture, propose_walking_description
from frontal_biped.model.urdf.description import RobotDescription, read_description
from frontal_biped.model.urdf.draft import Proposal, legs_of, urdf_key
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.whole_model import build_model, posture_configuration

BENT = "_bent"
"""What the name of a robot with bent knees ends on."""

ROOM = 0.1
"""Distance of the feet in x for which a described posture must leave room, of the length of a leg [-]."""

FREER = 2.0
"""How much more the swing foot may turn in a second search, where the first found no gait and no remedy [-]."""

Tell = Callable[[str], None]
"""Called with a line that says what is being done."""


@dataclass(frozen=True, eq=False)
class ReadyToWalk:
    """Robot and gait of a walk in space.

    Attributes:
        biped: the robot, its knees bent where they can.
        gait: a gait for it.
        made: files that were made for it, now.
    """

    biped: FrontalBiped
    gait: Gait
    made: tuple[Path, ...]


def prepare_to_walk(
    robot: str | Path, folder: Path | str = ".", gait: Path | None = None, on_progress: Tell | None = None
) -> ReadyToWalk:
    """A robot with bent knees and a gait for it.

    Args:
        robot: name of a packaged robot, a description (``.toml``), or a URDF.
        folder: where what is made is kept. A description is kept beside the URDF unless that is below the folder or is
            one of the installed example-robot-data.
        gait: file of the gait; None: see the module.
        on_progress: called with a line before anything that takes time, and for whatever is worth knowing.

    Raises:
        RobotError: the robot cannot be read, or something about it must be settled by hand: the line says what, and in
            which file.
        DesignFailedError: no gait was found; the line says what stands in the way.
        GaitFileError: a gait file cannot be used.
        OSError: a folder cannot be written to.
    """
    maker = _Maker(Path(folder), on_progress or (lambda line: None))
    biped = maker.robot(robot)
    return ReadyToWalk(biped, maker.gait(biped, gait), tuple(maker.made))


class _Maker:
    """Makes what is missing, and remembers what it made."""

    def __init__(self, folder: Path, tell: Tell) -> None:
        self.folder, self.tell = folder, tell
        self.made: list[Path] = []

    # ------------------------------------------------------------------ the robot
    def robot(self, asked: str | Path) -> FrontalBiped:
        """The robot asked for, its knees bent."""
        urdf = Path(asked)
        if urdf.suffix == ".urdf" and urdf.is_file() and not urdf.with_suffix(".toml").is_file():
            return self._described(urdf)
        path = description_path(asked)
        description = read_description(path)
        if path.stem.endswith(BENT) or _has_room(description):
            return load_robot(path)
        packaged = _packaged_bent(description)
        if packaged is not None:
            self.tell(f"{description.name} walks as {packaged}, whose knees are bent")
            return load_robot(packaged)
        return self._bent(path, description)

    def _described(self, urdf: Path) -> FrontalBiped:
        name = f"{urdf.stem}{BENT}"
        target = self._place(urdf) / f"{name}.toml"
        if not self._kept(target, urdf):
            self.tell(f"describing {urdf.name}: legs, knees bent for steps, soles")
            self._keep(target, propose_walking_description(urdf, target.parent, name))
        return self._settled(target)

    def _bent(self, path: Path, description: RobotDescription) -> FrontalBiped:
        name = f"{path.stem}{BENT}"
        target = self._place(description.urdf) / f"{name}.toml"
        if not self._kept(target, description.urdf):
            self.tell(f"bending the knees of {description.name}, far enough for steps")
            self._keep(target, propose_bent_posture(path, name=name, folder=target.parent))
        return self._settled(target)

    def _place(self, urdf: Path) -> Path:
        """Folder of a description that is made: it names its URDF from there, downwards."""
        try:
            urdf_key(urdf, self.folder)
            folder = self.folder
        except RobotError:
            folder = urdf.parent
        require_folder(folder)
        return folder

    def _kept(self, target: Path, urdf: Path) -> bool:
        """Was it made before, for the same URDF?"""
        if not target.exists():
            return False
        found = read_description(target).urdf
        if found.resolve() != urdf.resolve():
            raise RobotError(f"{target}: is there and describes {found}, not {urdf}; move it away")
        self.tell(f"using {target}, made before")
        return True

    def _keep(self, target: Path, proposal: Proposal) -> None:
        write_text(target, proposal.text)
        self.made.append(target)
        self.tell(f"kept as {target}")
        for line in proposal.undecided:
            self.tell(f"not decided: {line}")

    def _settled(self, target: Path) -> FrontalBiped:
        try:
            return load_robot(target)
        except RobotError as error:
            if target in self.made:
                raise RobotError(f"{error}; what is not decided stands at its head: settle it, then walk it") from None
            raise

    # ------------------------------------------------------------------ the gait
    def gait(self, biped: FrontalBiped, asked: Path | None) -> Gait:
        """The gait asked for, a packaged one, one made before, or one made now."""
        if asked is not None:
            gait = load_gait(asked)
            if gait.robot.fingerprint != biped.fingerprint:
                self.tell(
                    f"warning: {asked} was designed for {gait.robot.name!r} with another URDF or description than"
                    f" {biped.path.name}"
                )
            return gait
        file = f"{biped.name}.gait.json"
        packaged = models_dir() / file
        if packaged.is_file():
            gait = load_gait(packaged)
            if gait.robot.fingerprint == biped.fingerprint:
                return gait
        target = self.folder / file
        if target.exists():
            gait = load_gait(target)
            if gait.robot.fingerprint != biped.fingerprint:
                raise GaitFileError(
                    f"{target}: is there and was designed for another URDF or description of {biped.name}; move it away"
                    " to have one designed, or name one with --gait"
                )
            self.tell(f"using {target}, made before")
            return gait
        require_folder(self.folder)
        self.tell(f"designing a gait for {biped.name}")
        spec = default_specification(biped)
        result = optimise_gait(biped, spec)
        if result.gait is None and result.remedy is not None:
            remedy = result.remedy
            self.tell(f"with {remedy.key} = {remedy.new:.4g} in place of {remedy.old:.4g}, which leaves none")
            result = optimise_gait(biped, remedy.specification)
        elif result.gait is None and spec.max_foot_rotation is not None:
            freer = FREER * spec.max_foot_rotation
            self.tell(
                f"with max_foot_rotation = {freer:.4g} in place of {spec.max_foot_rotation:.4g}, which found none"
            )
            result = optimise_gait(biped, replace(spec, max_foot_rotation=freer))
        if result.gait is None:
            raise DesignFailedError(f"no gait: {biped.name}: {result.message}; change [gait] in {biped.path}")
        save_gait(result.gait, target)
        self.made.append(target)
        self.tell(f"kept as {target}")
        return result.gait


def _packaged_bent(description: RobotDescription) -> str | None:
    """Name of the packaged robot of the same URDF whose knees are bent; None: there is none."""
    for name in robot_names():
        if name.endswith(BENT) and read_description(models_dir() / f"{name}.toml").urdf == description.urdf:
            return name
    return None


def _has_room(description: RobotDescription) -> bool:
    """Are the knees bent enough for a short step?"""
    full = build_model(description, read_urdf(description.urdf))
    posture = posture_configuration(full, description)
    step = ROOM * leg_length(description, full)
    legs = legs_of(description, full)
    return room_for_steps(full, legs, description.joints, posture, step) >= step
