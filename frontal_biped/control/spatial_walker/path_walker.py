"""The walker that stands, starts, walks along a path and stands again.

On one foot it is a `SpatialWalker` whose steps a `PathFollower` plans. On both it is led by `StandingLaw` under
`BothFeetProgram`; the estimator takes one of the feet for the stance foot there too, the one that is to carry the first
step. Where it is, it knows by its own steps only.
"""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.path.follower import PathFollower
from frontal_biped.control.path.pose import Pose
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.standing import StandingLaw, StandingSettings, Start, push_off_speed
from frontal_biped.control.spatial_walker.swing_path import MinimumJerk
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.control.whole_body.both_feet import BothFeetProgram, BothFeetTargets
from frontal_biped.control.whole_body.targets import LegLength, Yaw
from frontal_biped.model.space.virtual_legs import YAW, SpaceState, X, Y
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase


class PathWalker(SpatialWalker):
    """Follows a path, from sensor readings alone.

    Args:
        walker_arguments: of `SpatialWalker`, by position.
        follower: of the path.
        standing: how it stands.
        options: of `SpatialWalker`, by name.

    Attributes:
        follower: of the path.
        standing: does it stand on both feet?
        both_feet: the program of double support.
        odometry: where the robot believes to be, by its own steps and the inertial unit.
    """

    follower: PathFollower

    def __init__(
        self,
        *walker_arguments: Any,
        follower: PathFollower,
        standing: StandingSettings | None = None,
        **options: Any,
    ) -> None:
        self.follower = follower
        self.standing = True
        self._standing_settings = standing or StandingSettings()
        super().__init__(*walker_arguments, planner=follower, **options)

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Stand on both feet at q (nq,), v (nv,)."""
        super().reset(stance, q, v)
        if not hasattr(self, "both_feet"):
            self.both_feet = BothFeetProgram(self.free, self.settings, self.program.rows.outside)
            self._law = StandingLaw(self.sagittal, self._standing_settings)
        self.both_feet.reset()
        self._lengths = {side: MinimumJerk() for side in Stance}
        self._stand()
        self._stood = 0.0

    @property
    def finished(self) -> bool:
        """Does the robot stand at the end of the path?"""
        return self.follower.finished

    @property
    def odometry(self) -> Pose:
        """Middle between both soles and mean of where they look, as the robot believes."""
        state = self.state.at(self.estimator.q, self.estimator.v, self.plan.heading)
        left, right = (state.feet[side] for side in (Stance.LEFT, Stance.RIGHT))
        x, y, _ = state.to_world(0.5 * (left.position + right.position)).tolist()
        turned = 0.5 * float(left.turning.angles[YAW] + right.turning.angles[YAW])
        return Pose(x, y, self.plan.heading + turned)

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading, one period after the last."""
        self._estimate(reading)
        if not self.standing:
            if not self._lands(reading):
                return self._step(None)
            x, y, _ = self.estimator.sole(self.stance.other).tolist()
            landing = Pose(x, y, self.plan.next_yaw)
            if not self.follower.arrives(self.stance.other, landing):
                self._land()
                return self._step(PhaseEvent.LANDING)
            self._come_to_stand(landing)
            return self._balance(PhaseEvent.LANDING)
        return self._balance(None)

    # ------------------------------------------------------------------ on both feet
    def _come_to_stand(self, foot: Pose) -> None:
        """The last foot has landed."""
        self.estimator.land()
        self.landings += 1
        self.stance = self.stance.other
        self._since = 0.0
        self._sent.clear()
        self._expected = None
        last = self.plan
        self.plan = self.plan._replace(yaw=foot.yaw, length=0.0, aside=0.0, turn=0.0, next_length=0.0, next_turn=0.0)
        self._pelvis_yaw.start(self._pelvis_yaw.x + last.heading - foot.yaw, 0.0)
        self._stand()

    def _stand(self) -> None:
        """Begin to stand."""
        self.standing, self._stood, self._on_two = True, 0.0, 0.0
        self._start: Start | None = None
        self._gathered = self._push_off = 0.0
        state = self.state.at(self.estimator.q, self.estimator.v, self.plan.heading)
        for side, led in self._lengths.items():
            length = self._length(state, side)
            led.start(length.offset, length.rate)

    def _balance(self, event: PhaseEvent | None) -> SpatialCommand:
        """Torques on both feet, or on one if it is time to lift the other."""
        h = self.period
        self._since += h
        self._on_two += h
        state = self._seen()
        still = float(np.hypot(*state.com_velocity[: Y + 1])) < self._standing_settings.still
        self._stood = self._stood + h if still and self._on_two > self._standing_settings.settled else 0.0
        if self._start is None:
            if self.follower.stand(self._stood) and (still or self._stood):
                self._gather()
        else:
            self._gathered += h
            if self._lift_now(state):
                self._lift()
                return self._step(event)
        self._lead_lengths()
        left = self._standing_settings.recovery - self._on_two
        if left > 3.0 * h:
            self._pelvis_yaw.towards(0.0, left, h)
        else:
            self._pelvis_yaw.start(0.0, 0.0)
        balance = self._law.at(state, self._start, self._gathered)
        lengths = {side: LegLength(led.x, led.dx, led.ddx) for side, led in self._lengths.items()}
        yaw = self._pelvis_yaw
        solution = self.both_feet.solve(
            state,
            BothFeetTargets(
                balance.acceleration,
                balance.share,
                self._posture,
                self._softness(),
                lengths[Stance.LEFT],
                lengths[Stance.RIGHT],
                Yaw(yaw.x, yaw.dx, yaw.ddx),
            ),
        )
        self._send(solution.dv)
        stance = self.stance
        seen, foot = state.frontal(stance), state.feet[stance]
        other = state.to_world(state.feet[stance.other].position)
        own = solution.wrench if stance is Stance.LEFT else solution.other_wrench
        ahead = 0.5 * (foot.position + state.feet[stance.other].position)[X] + balance.cop[X] - foot.position[X]
        aside = balance.cop[Y] - stance.sign * 0.5 * abs(foot.position[Y] - state.feet[stance.other].position[Y])
        return SpatialCommand(
            solution.tau,
            StepPhase.RISING,
            stance,
            event,
            seen.q,
            seen.dq,
            np.zeros(3),
            float(-stance.sign * aside),
            float(ahead),
            np.array([other[X], other[Y], self.plan.yaw]),
            np.concatenate([state.to_world(own[:3]), state.to_world(own[3:])]),
            0.0,
            solution.solved,
            solution.given_way,
        )

    # ------------------------------------------------------------------ into the first step
    def _gather(self) -> None:
        """Begin the first step: way is gathered for it."""
        first, frontal, settings = self.follower.first_stance, self.frontal, self._standing_settings
        self.estimator.stand_on(first)
        self.stance = first
        orbit, width = frontal.orbit, frontal.widths.width
        s = orbit.ends(StepPhase.RISING)
        speed = float(np.sqrt(2.0 * orbit.energy(StepPhase.RISING, s)))
        self._push_off = push_off_speed(self.biped, self.gait, speed)
        half = 0.5 * width
        self._start = Start(
            self.sagittal.omega, settings.reach * half, settings.ramp, settings.given, half - s, speed, first
        )
        self._gathered = 0.0

    def _lead_lengths(self) -> None:
        """One period on: both legs to their own lengths, and the one that is to swing pushes off before it does."""
        h = self.period
        for side, led in self._lengths.items():
            left, speed = self._standing_settings.recovery - self._on_two, 0.0
            if self._start is not None and side is not self.stance:
                left, speed = self._start.duration - self._gathered, self._push_off
                if left > self._standing_settings.push_off:
                    continue
            if left > 3.0 * h:
                led.towards(0.0, left, h, speed)
            elif speed:
                led.coast(speed, h)
            else:
                led.start(0.0, 0.0)

    def _lift_now(self, state: SpaceState) -> bool:
        """Is the energy sideways that of the orbit, or is it late?"""
        assert self._start is not None
        late = self._gathered - self._start.duration
        if late < -0.5 * self._standing_settings.ramp:
            return False
        sway = state.sway(self.stance)
        there = sway.rate < 0.0 and self.frontal.orbit.error(StepPhase.RISING, sway.value, sway.rate) >= 0.0
        return there or late > self._standing_settings.late

    def _lift(self) -> None:
        """The first step begins: the other foot is free."""
        self.standing, self._start = False, None
        self.phases.reset()
        self.phases.stands(max(self.estimator.clearance(self.stance.other), 0.0))
        self._since = np.inf
        self._begin_step(self.stance, None)

    def counters(self) -> dict[str, Any]:
        """What happened so far."""
        return {
            **super().counters(),
            **{f"both_feet_{how}": count for how, count in self.both_feet.counts.items()},
            "odometry": list(self.odometry),
            "asked": list(self.follower.legs[-1].target),
        }
