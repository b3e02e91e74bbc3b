"""A walk in three lines: what was reached, which limit was nearest, what it needed of the motors."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.files.counted import counted
from frontal_biped.gait.sideways import AnyGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation.falls import fall_remedy
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory


@dataclass(frozen=True)
class Use:
    """How much of a limit a walk used at most.

    Attributes:
        what: is limited.
        value: the largest.
        limit: of it; infinite where there is none.
        unit: of both.
    """

    what: str
    value: float
    limit: float
    unit: str

    @property
    def share(self) -> float:
        """Of the limit [-]."""
        return self.value / self.limit

    def __str__(self) -> str:
        if not np.isfinite(self.limit):
            return f"{self.what} {self.value:.3g} {self.unit}, which has no limit"
        return f"{self.what} {self.value:.3g} of {self.limit:.3g} {self.unit}, {100.0 * self.share:.0f} %"


@dataclass(frozen=True)
class WalkSummary:
    """What a walk came to.

    Attributes:
        robot: name.
        outcome: "completed", or what made the robot fall.
        remedy: what to change against the fall; None where it did not fall, or nothing of the specification governs it.
        asked: steps asked for.
        steps: completed.
        duration: [s].
        uses: of the ground and the sole.
        torque: of the joint that came nearest to its limit.
        speed: likewise.
    """

    robot: str
    outcome: str
    remedy: str | None
    asked: int
    steps: int
    duration: float
    uses: tuple[Use, ...]
    torque: Use
    speed: Use

    @property
    def tightest(self) -> Use:
        """The limit that was nearest."""
        return max((*self.uses, self.torque, self.speed), key=lambda use: use.share)

    def as_dict(self) -> dict[str, Any]:
        """For JSON; a limit that there is not is null."""

        def told(use: Use) -> dict[str, Any]:
            finite = bool(np.isfinite(use.limit))
            return asdict(use) | ({"share": use.share} if finite else {"limit": None, "share": None})

        motors = {"torque": told(self.torque), "speed": told(self.speed)}
        return {"remedy": self.remedy, "tightest": told(self.tightest), "motors": motors}

    def __str__(self) -> str:
        fate = "walked" if self.outcome == COMPLETED else f"FELL ({self.outcome}) after"
        advice = "" if self.remedy is None else f"; {self.remedy}"
        return "\n".join(
            [
                f"{self.robot}: {fate} {counted(self.steps, 'step')} of {self.asked} in {self.duration:.2f} s{advice}",
                f"tightest  {self.tightest}",
                f"motors    {self.torque}; {self.speed}",
            ]
        )


def walk_summary(biped: FrontalBiped, gait: AnyGait, run: Trajectory, asked: int) -> WalkSummary:
    """The summary of a run.

    Args:
        biped: the robot.
        gait: what it walked.
        run: the walk.
        asked: steps asked for.
    """
    # a foot that hardly bears has no friction to speak of
    pressed = run.force[:, 1] > gait.specification.min_normal_force * biped.weight
    friction = np.max(np.abs(run.force[pressed, 0]) / run.force[pressed, 1], initial=0.0)
    outer, inner = biped.sole
    sole = np.max(np.maximum(run.p_fri / inner, run.p_fri / outer), initial=0.0, where=np.isfinite(run.p_fri))
    furthest = inner if np.nanmax(run.p_fri / inner, initial=0.0) >= sole else -outer
    return WalkSummary(
        robot=run.robot,
        outcome=run.outcome,
        remedy=fall_remedy(run.outcome, gait.specification) if run.fell else None,
        asked=asked,
        steps=run.steps_completed,
        duration=float(run.t[-1]),
        uses=(
            Use("friction", float(friction), gait.specification.friction, "F_h/F_v"),
            Use("FRI from the ankle", float(1e3 * sole * furthest), 1e3 * furthest, "mm"),
        ),
        torque=_largest("torque of the", run.u, biped.max_torque, "N m"),
        speed=_largest("speed of the", run.dq, biped.joint_max_velocity, "rad/s"),
    )


def _largest(what: str, values: FloatArray, limits: FloatArray, unit: str) -> Use:
    """Of the joint that uses the largest share of its limit; where none has one, the largest."""
    most = np.nanmax(np.abs(values), axis=0)
    shares = np.where(np.isfinite(limits), most / limits, 0.0)
    joint = int(np.argmax(shares if np.any(shares) else most))
    return Use(f"{what} {JOINTS[joint]}", float(most[joint]), float(limits[joint]), unit)
