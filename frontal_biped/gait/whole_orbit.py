"""The periodic orbit of a gait as a motion of the whole robot, evenly sampled: every instant on the orbit itself."""

import numpy as np

from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.orbit_samples import TimedPhase
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.whole_motion import WholeMotion
from frontal_biped.model.space.whole_placing import PlanarSamples, place_whole_robot
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit

AT_ONCE = 1e-9
"""Within this time of an event an instant counts as at it [s]."""


def whole_orbit(
    biped: FrontalBiped, phases: tuple[Phase, Phase], step: StepOrbit, step_width: float, rate: float, steps: int
) -> WholeMotion:
    """Steps of the periodic orbit, the first on the left foot from right after an impact.

    Args:
        biped: the robot.
        phases: virtual constraints of the rising and the falling phase.
        step: the orbit of one step.
        step_width: distance between the ankles [m].
        rate: samples per second; an instant at which two phases meet belongs to the later one.
        steps: how many.

    Raises:
        SpecificationError: rate or steps is not positive.
        RobotError: see `place_whole_robot`.
    """
    if not (np.isfinite(rate) and rate > 0.0):
        raise SpecificationError(f"rate = {rate!r} is no positive number of samples per second; write rate=500.0")
    if steps < 1:
        raise SpecificationError(f"steps = {steps!r} is less than one; write steps=2 for one step on either foot")
    rising, falling = (
        TimedPhase(biped, phase, orbit) for phase, orbit in zip(phases, (step.rising, step.falling), strict=True)
    )
    duration = rising.duration + falling.duration
    t = np.arange(int(np.floor(steps * duration * rate + 1e-9)) + 1) / rate
    index = np.minimum(np.floor((t + AT_ONCE) / duration), steps - 1.0)
    within = t - index * duration
    rises = within + AT_ONCE < rising.duration
    states = {name: np.zeros((len(t), 4)) for name in ("q", "dq", "u")}
    for part, timed, begins in ((rises, rising, 0.0), (~rises, falling, rising.duration)):
        found = timed.at(within[part] - begins)
        for name, values in states.items():
            values[part] = getattr(found, name)
    stance = 1.0 - 2.0 * (index % 2.0)
    phase = np.where(rises, 1.0, -1.0)
    samples = PlanarSamples(
        t, **states, phase=phase, stance=stance, stance_y=0.5 * step_width * stance, step=index, bears=np.ones(len(t))
    )
    return place_whole_robot(biped, samples)
