"""Robustness card of a gait: from which speeds it returns, what pushes it survives, and what limits it.

Speeds from the restricted map in closed form, every contact constraint kept on the way; for the paper's fixed
transitions, which leave Z at once, and for pushes from the full model at 1 kHz. The parts are independent of each
other and can be computed in several processes; the card is the same.

``frontal-biped analyze G.json --robustness`` prints the card. For three gaits of the Table I robot it says of the
speeds after an impact from which the gait is reached again within 60 steps, with friction, unilateral contact, FRI and
torques all within their limits:

    speeds that return      reference       pelvis within 5 deg    robust
    adaptive                 -6 .. +30 %     -25 .. +75 %          -25 .. +97 %
    ankle                   -14 .. +35 %     -31 .. +97 %          -95 .. +113 %
    step                     -2 .. +17 %      -6 .. +38 %          -31 .. +10 %
    step-lqr                 -2 .. +16 %     -11 .. +7 %           -38 .. +78 %
    ankle+step              -13 .. +40 %     -13 .. +52 %          -41 .. +113 %

An interval ends at the first speed that does not return, or at -95 %, where the search ends. The step laws have gaps:
``step`` on ``robust`` fails from +11 to +13 % and returns from there to +77 %. They have little room on gaits that move
beta by 0.02 to 0.04 rad: a few centimetres of width are all of it. Adaptive transitions return from slow landings less
far than from fast ones: what a falling phase can gain within the torque limits ends there.

These are statements of the closed form, for continuous control. The full model under continuous control was compared
with the map for one step from each of twelve speeds, end to end of the intervals of ``adaptive`` and ``ankle`` on the
three gaits: the next speed is the map's to 1e-5. Walked in full from both ends and half-way to them, ``adaptive`` on
``robust`` is back within 1 % after 17 to 33 steps.

Torques held for 1 ms give less where the speed is low (``frontal-biped simulate robust.json --stabiliser ankle
--speed-error -0.91`` and the like). ``ankle`` on ``robust`` falls after 1 to 3 steps from -91 % and
below (-91 to -95 % tried), walks on from -90 % without being back within 8 steps, is back after 6 steps from -70 %,
after 4 from -60 %, and returns from +60 .. +113 % (steps of 10 and 20 %). ``adaptive`` on ``robust`` falls from every
slower speed tried (-2.5 % after 31 steps, -25 % after 4) and returns from +10 .. +87 %: re-anchoring spends no ankle
torque on the energy that a held torque loses. At 1 kHz take ``ankle``.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, as_completed
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from frontal_biped.analysis.fixed_basin import fixed_basin
from frontal_biped.analysis.push_recovery import INSTANTS, PUSH_RESOLUTION, PushOutcome, largest_pushes
from frontal_biped.analysis.return_map import Basin, RestrictedMap
from frontal_biped.control.stabilisers.by_name import STABILISERS, make_stabiliser
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.files.counted import counted
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.zero_dynamics.half_steps import rising_energy

SAMPLES = 13
"""Speeds at which a map is sampled, over the interval that returns and a little more."""

COMPARED = tuple(name for name in STABILISERS if name != "re-anchored")
"""Stabilisers of a card: "adaptive" is re-anchoring at its best, and plain re-anchoring is in the laws."""


class MapSummary(NamedTuple):
    """What the closed form says of one stabiliser.

    Attributes:
        slope: derivative of the restricted map below and above the gait [-].
        basin: interval of post-impact speeds that return.
        samples: (speed, next speed), relative to the gait's; nan where there is no step or it breaks a limit.
    """

    slope: tuple[float, float]
    basin: Basin
    samples: tuple[tuple[float, float], ...]

    @property
    def sensitivity_norm(self) -> float:
        """sqrt(sum over steps of (error_k / error_0)^2) of the map linearised on its steeper side [-]."""
        steepest = max(map(abs, self.slope))
        return float(1.0 / np.sqrt(1.0 - steepest**2)) if steepest < 1.0 else float("inf")


@dataclass(frozen=True)
class RobustnessCard:
    """How much a gait can take.

    Attributes:
        gait_multiplier: closed form, with exact transitions [-].
        slopes: derivative of the restricted map below and above the gait, by stabiliser [-].
        basins: interval of post-impact speeds that return, by stabiliser.
        sensitivity_norm: by stabiliser, sqrt(sum over steps of (error_k / error_0)^2) of the linearised map: the gait
            sensitivity norm with the post-impact speed as both disturbance and indicator [-].
        barrier_margin: energy that may be added after the impact before the robot tips outwards, over its own, on the
            planned rising phase as `ReanchoringTransitions` continues it [-].
        sampled_maps: (speed, next speed) over the interval that returns, by stabiliser; nan where there is no step or
            it breaks a limit.
        push_stabiliser: with which the pushes were walked.
        pushes: largest survived.
    """

    gait_multiplier: float
    slopes: dict[str, tuple[float, float]]
    basins: dict[str, Basin]
    sensitivity_norm: dict[str, float]
    barrier_margin: float
    sampled_maps: dict[str, tuple[tuple[float, float], ...]]
    push_stabiliser: str
    pushes: tuple[PushOutcome, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON; what does not exist is null."""
        table = asdict(self)
        table["sampled_maps"] = {
            name: [[speed, None if np.isnan(after) else after] for speed, after in pairs]
            for name, pairs in self.sampled_maps.items()
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
            steps = counted(push.steps_to_recover, "step")
            text = f"{push.impulse:.1f} N s, recovered in {steps} (more: {push.limited_by})"
            found.append((f"push {push.direction}, {push.instant}", text))
        return found

    def __str__(self) -> str:
        return "\n".join(f"{name:44} {text}" for name, text in self.rows())


def robustness_card(
    biped: FrontalBiped,
    gait: Gait,
    *,
    stabilisers: Sequence[str] = COMPARED,
    push_stabiliser: str = "ankle",
    instants: Sequence[tuple[str, float]] = INSTANTS,
    push_resolution: float = PUSH_RESOLUTION,
    samples: int = SAMPLES,
    executor: Executor | None = None,
    on_progress: Callable[[str], None] | None = None,
) -> RobustnessCard:
    """Measure the robustness of a gait.

    Args:
        biped: the robot.
        gait: the gait.
        stabilisers: names of `STABILISERS` whose basins to find.
        push_stabiliser: with which to take pushes.
        instants: name and place in the step of each push; none: no pushes.
        push_resolution: of the largest pushes [N s].
        samples: number of speeds at which each map is sampled.
        executor: runs the parts beside this process; default: this process alone, one after the other.
        on_progress: called with what is being done.

    Raises:
        SimulationError: a stabiliser is unknown.
    """
    for name in (*stabilisers, push_stabiliser):
        make_stabiliser(name, biped, gait)
    parts: dict[str, tuple[Callable[..., Any], tuple[Any, ...]]] = {}
    for name in stabilisers:
        parts[f"speeds that return, {name}"] = (
            (fixed_basin, (biped, gait)) if name == "fixed" else (summarise_map, (biped, gait, name, samples))
        )
    for instant, place in instants:
        case = (biped, gait, push_stabiliser, instant, place, push_resolution)
        parts[f"largest pushes, {instant}"] = (largest_pushes, case)
    results = _compute(parts, executor, on_progress or (lambda _: None))
    basins: dict[str, Basin] = {}
    maps: dict[str, MapSummary] = {}
    for name in stabilisers:
        found = results[f"speeds that return, {name}"]
        if isinstance(found, MapSummary):
            maps[name] = found
        basins[name] = found.basin if isinstance(found, MapSummary) else found
    energy = rising_energy(biped, ReanchoringTransitions(biped, gait).planned_rising)
    own = 0.5 * (energy.start_inertia * gait.orbit.beta_dot_after_impact) ** 2
    return RobustnessCard(
        gait_multiplier=gait.orbit.multiplier,
        slopes={name: found.slope for name, found in maps.items()},
        basins=basins,
        sensitivity_norm={name: found.sensitivity_norm for name, found in maps.items()},
        barrier_margin=energy.highest / own - 1.0,
        sampled_maps={name: found.samples for name, found in maps.items()},
        push_stabiliser=push_stabiliser,
        pushes=tuple(push for instant, _ in instants for push in results[f"largest pushes, {instant}"]),
    )


def _compute(
    parts: dict[str, tuple[Callable[..., Any], tuple[Any, ...]]], executor: Executor | None, say: Callable[[str], None]
) -> dict[str, Any]:
    """The result of each part, in the order of the parts; an executor begins with the first, this process at the end.

    The closed forms take longest and come first, so that no process is left with one of them at the end.
    """
    futures: dict[Future[Any], str] = {}
    if executor is not None:
        futures = {executor.submit(function, *arguments): name for name, (function, arguments) in parts.items()}
    waiting = {name: future for future, name in futures.items()}
    results: dict[str, Any] = {}
    for name in parts if executor is None else reversed(parts):
        if name in waiting and not waiting[name].cancel():
            continue
        function, arguments = parts[name]
        say(f"{len(results) + sum(future.done() for future in futures)}/{len(parts)} done; {name}")
        results[name] = function(*arguments)
    for future in as_completed(future for future, name in futures.items() if name not in results):
        results[futures[future]] = future.result()
        say(f"{len(results)}/{len(parts)} done; last {futures[future]}")
    return {name: results[name] for name in parts}


def summarise_map(biped: FrontalBiped, gait: Gait, stabiliser: str, samples: int = SAMPLES) -> MapSummary:
    """Slope, basin and samples of the restricted map under a stabiliser, by name."""
    restricted = RestrictedMap(biped, gait, make_stabiliser(stabiliser, biped, gait))
    basin = restricted.basin()
    beyond = 0.1 * (basin.high - basin.low)
    speeds = np.linspace(max(basin.low - beyond, 0.02), basin.high + beyond, samples)
    following = restricted.sample(speeds)
    pairs = tuple((float(a), float(b)) for a, b in zip(speeds, following, strict=True))
    return MapSummary(restricted.slope(), basin, pairs)
