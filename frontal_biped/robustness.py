"""Robustness card of a gait: from which speeds it returns, what pushes it survives, and what limits it.

Speeds from the restricted map in closed form, every contact constraint kept on the way; for the paper's fixed
transitions, which leave Z at once, and for pushes from the full model at 1 kHz.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from frontal_biped.control.stabilisers import STABILISERS, make_stabiliser
from frontal_biped.control.transitions import AdaptiveTransitions
from frontal_biped.gait import Gait
from frontal_biped.half_steps import rising_energy
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.return_map import Basin, RestrictedMap
from frontal_biped.simulation.disturbances import Disturbances
from frontal_biped.simulation.pushes import Push
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.walking import simulate

PERIOD = 1e-3  # [s]
PUSH_DURATION = 0.05  # [s]
INSTANTS = (("just after the impact", 0.02), ("half-way up", 0.5), ("at the reversal", 1.0), ("half-way down", 1.5))
"""Name and place in the step: 0 impact, 1 reversal, 2 next impact, by time within each phase."""

SAMPLED_SPEEDS = tuple(float(ratio) for ratio in np.round(np.linspace(0.2, 2.2, 41), 3))

PUSH_STEPS = 6
"""Steps walked after a push."""

RECOVERED = 0.05
"""Relative error of the post-impact speed that counts as recovered; 1 kHz control alone costs 0.003."""

LARGEST_PUSH = 60.0
"""Largest push tried [N s]."""

PUSH_RESOLUTION = 1.0  # [N s], or a tenth of the push
SPEED_RESOLUTION = 0.005


@dataclass(frozen=True)
class PushOutcome:
    """The largest push survived at one instant in one direction.

    Attributes:
        instant: of the first step.
        direction: "outwards", away from the swing foot, or "inwards".
        impulse: largest survived [N s].
        steps_to_recover: steps after it until the speed is within `RECOVERED` of the gait's.
        limited_by: what became of the next larger one.
    """

    instant: str
    direction: str
    impulse: float
    steps_to_recover: int
    limited_by: str


@dataclass(frozen=True)
class RobustnessCard:
    """How much a gait can take.

    Attributes:
        gait_multiplier: closed form, with exact transitions [-].
        slopes: derivative of the restricted map below and above the gait, by stabiliser [-].
        basins: interval of post-impact speeds that return, by stabiliser.
        sensitivity_norm: by stabiliser, sqrt(sum over steps of (error_k / error_0)^2) of the linearised map: the gait
            sensitivity norm with the post-impact speed as both disturbance and indicator [-].
        barrier_margin: energy that may be added after the impact before the robot tips outwards, over its own [-].
        sampled_speeds: post-impact speeds, relative to the gait's [-].
        sampled_maps: the next ones, by stabiliser; nan where there is no step or it breaks a limit.
        push_stabiliser: with which the pushes were walked.
        pushes: largest survived.
    """

    gait_multiplier: float
    slopes: dict[str, tuple[float, float]]
    basins: dict[str, Basin]
    sensitivity_norm: dict[str, float]
    barrier_margin: float
    sampled_speeds: tuple[float, ...]
    sampled_maps: dict[str, tuple[float, ...]]
    push_stabiliser: str
    pushes: tuple[PushOutcome, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON; what does not exist is null."""
        table = asdict(self)
        table["sampled_maps"] = {
            name: [None if np.isnan(value) else value for value in values] for name, values in self.sampled_maps.items()
        }
        table["sensitivity_norm"] = {
            name: value if np.isfinite(value) else None for name, value in self.sensitivity_norm.items()
        }
        return table

    def rows(self) -> list[tuple[str, str]]:
        """(name, text) for a report."""
        found = [
            ("multiplier", f"{self.gait_multiplier:.4f}"),
            ("energy margin to the barrier", f"{100.0 * self.barrier_margin:.1f} % of the post-impact energy"),
        ]
        for name, basin in self.basins.items():
            found.append((f"speeds that return, {name}", str(basin)))
            if name in self.slopes:
                below, above = self.slopes[name]
                norm = self.sensitivity_norm[name]
                text = f"slope of the map {below:.3f} below, {above:.3f} above; sensitivity norm {norm:.2f}"
                found.append((f"  at the gait, {name}", text))
        for push in self.pushes:
            text = f"{push.impulse:.1f} N s, recovered in {push.steps_to_recover} steps (more: {push.limited_by})"
            found.append((f"push {push.direction}, {push.instant}", text))
        return found

    def __str__(self) -> str:
        return "\n".join(f"{name:44} {text}" for name, text in self.rows())


def robustness_card(
    biped: FrontalBiped,
    gait: Gait,
    *,
    stabilisers: Sequence[str] = tuple(STABILISERS),
    push_stabiliser: str = "ankle",
    instants: Sequence[tuple[str, float]] = INSTANTS,
    on_progress: Callable[[str], None] | None = None,
) -> RobustnessCard:
    """Measure the robustness of a gait; several minutes with every stabiliser and every push.

    Args:
        biped: the robot.
        gait: the gait.
        stabilisers: names of `STABILISERS` whose basins to find.
        push_stabiliser: with which to take pushes.
        instants: name and place in the step of each push; none: no pushes.
        on_progress: called with what is being done.

    Raises:
        SimulationError: a stabiliser is unknown.
    """
    say = on_progress or (lambda _: None)
    slopes: dict[str, tuple[float, float]] = {}
    basins: dict[str, Basin] = {}
    maps: dict[str, tuple[float, ...]] = {}
    for name in stabilisers:
        say(f"speeds that return, {name}")
        if name == "fixed":
            basins[name] = fixed_basin(biped, gait)
            continue
        restricted = RestrictedMap(biped, gait, make_stabiliser(name, biped, gait))
        slopes[name] = restricted.slope()
        basins[name] = restricted.basin()
        maps[name] = tuple(float(value) for value in restricted.sample(np.array(SAMPLED_SPEEDS)))
    pushes = []
    for instant, place in instants:
        for direction in ("outwards", "inwards"):
            say(f"largest push {direction}, {instant}")
            pushes.append(largest_push(biped, gait, push_stabiliser, instant, place, direction))
    energy = rising_energy(biped, AdaptiveTransitions(biped, gait).planned_rising)
    own = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    return RobustnessCard(
        gait_multiplier=gait.orbit.multiplier,
        slopes=slopes,
        basins=basins,
        sensitivity_norm={name: _norm(max(map(abs, pair))) for name, pair in slopes.items()},
        barrier_margin=energy.highest / own - 1.0,
        sampled_speeds=SAMPLED_SPEEDS,
        sampled_maps=maps,
        push_stabiliser=push_stabiliser,
        pushes=tuple(pushes),
    )


def _norm(slope: float) -> float:
    return float(1.0 / np.sqrt(1.0 - slope**2)) if slope < 1.0 else float("inf")


def fixed_basin(biped: FrontalBiped, gait: Gait) -> Basin:
    """Speeds from which the paper's fixed transitions return, by simulation at 1 kHz."""

    def survives(error: float) -> tuple[bool, str]:
        run = simulate(biped, gait, steps=PUSH_STEPS, period=PERIOD, speed_error=error, stabiliser="fixed")
        return _recovered(run, gait)

    ends = []
    for sense in (-1.0, 1.0):
        good, why = 0.0, "nothing up to the end of the search"
        for size in (0.02, 0.05, 0.1, 0.2, 0.4):
            walks, reason = survives(sense * size)
            if not walks:
                bad, why = size, reason
                while bad - good > SPEED_RESOLUTION:
                    middle = 0.5 * (good + bad)
                    walks, reason = survives(sense * middle)
                    good, bad, why = (middle, bad, why) if walks else (good, middle, reason)
                break
            good = size
        ends.append((1.0 + sense * good, why))
    return Basin(ends[0][0], ends[1][0], ends[0][1], ends[1][1])


def largest_push(
    biped: FrontalBiped, gait: Gait, stabiliser: str, instant: str, place: float, direction: str
) -> PushOutcome:
    """The largest push survived at an instant of the first step, by bisection on its impulse.

    Args:
        biped: the robot.
        gait: the gait.
        stabiliser: by name.
        instant: what the place is called.
        place: 0 impact, 1 reversal, 2 next impact.
        direction: "outwards" or "inwards", of the first stance foot.
    """
    step = gait.step(biped)
    up, down = step.rising.duration, step.falling.duration
    start = place * up if place <= 1.0 else up + (place - 1.0) * down
    # the left foot stands first: outwards is to the left
    sign = 1.0 if direction == "outwards" else -1.0

    def survives(impulse: float) -> tuple[bool, str, int]:
        push = Push(start, PUSH_DURATION, sign * impulse)
        run = simulate(
            biped,
            gait,
            steps=PUSH_STEPS,
            period=PERIOD,
            stabiliser=stabiliser,
            disturbances=Disturbances(pushes=(push,)),
        )
        recovered, why = _recovered(run, gait)
        return recovered, why, _steps_to_recover(run, gait)

    good, steps, why = 0.0, 0, "nothing up to the end of the search"
    size = 2.0
    while size <= LARGEST_PUSH:
        walks, reason, count = survives(size)
        if walks:
            good, steps, size = size, count, 2.0 * size
            continue
        bad, why = size, reason
        while bad - good > max(PUSH_RESOLUTION, 0.1 * good):
            middle = 0.5 * (good + bad)
            walks, reason, count = survives(middle)
            if walks:
                good, steps = middle, count
            else:
                bad, why = middle, reason
        break
    return PushOutcome(instant, direction, good, steps, why)


def _errors(run: Trajectory, gait: Gait) -> "np.ndarray":
    return np.abs(run.post_impact_states()[:, 4] / gait.orbit.beta_dot_after_impact - 1.0)


def _recovered(run: Trajectory, gait: Gait) -> tuple[bool, str]:
    if run.fell:
        return False, run.outcome
    if _errors(run, gait)[-1] > RECOVERED:
        return False, f"not back within {run.steps_completed} steps"
    return True, ""


def _steps_to_recover(run: Trajectory, gait: Gait) -> int:
    """Steps after the pushed one until the speed error stays below `RECOVERED`."""
    late = np.flatnonzero(_errors(run, gait) > RECOVERED)
    return int(late[-1]) if len(late) else 0
