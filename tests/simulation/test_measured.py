"""What a step is measured by is what its name says."""

import numpy as np
import pytest

from frontal_biped.simulation.measured import StepMeter


def test_work_and_effort_of_a_step_are_those_of_its_ticks_alone():
    h, generator = 2e-3, np.random.default_rng(4)
    meter, work, effort = StepMeter(h), [], []
    for step in range(2):
        meter.begin_step(0.1 * step)
        ticks = generator.normal(size=(30, 2, 4))
        for tau, rates in ticks:
            meter.drive(tau, rates)
        meter.end_step()
        work.append(h * sum(abs(float(t * v)) for tau, rates in ticks for t, v in zip(tau, rates, strict=True)))
        effort.append(h * sum(float(t) ** 2 for tau, _ in ticks for t in tau))
    assert meter.measured.work == pytest.approx(work, rel=1e-12)
    assert meter.measured.effort == pytest.approx(effort, rel=1e-12)
