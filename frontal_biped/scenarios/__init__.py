"""Scenarios: scripted trials of a controller, in our simulator or in MuJoCo, with expectations.

A scenario is a short file (`frontal_biped.scenarios.file` has every key). It is run

* by ``frontal-biped trial wrong_masses.scenario.toml --repeat 100 --seed 1 --jobs 2``: a hundred trials, survival with
  its 95 % Wilson interval, and every expectation that failed with its trial, which ``--only K --save runs`` walks
  again for `view`. The same seed gives the same digits on any `concurrent.futures.Executor`
  (``run_trials(..., executor=...)``);
* by pytest: in a project that says ``frontal_biped_scenarios = true`` every ``*.scenario.toml`` is a test, and a
  failure is a report without a traceback (`frontal_biped.pytest_plugin`);
* from Python: ``run_scenario(load_scenario(path), controller=...)``.

Your own controller comes in by name, ``controller = "my_module:make"``, or from a test:

    def test_my_controller_survives_a_push(trial):
        result = trial("push.scenario.toml", controller=MyController)  # called as (robot, gait, period=...)
        assert result.measured["torque"] < 0.8

It has ``begin(phase, q, dq)`` and ``command(phase, q, dq)`` as `QpController`, which is told state and events (the
default in our simulator), or ``reset(stance, q, dq)`` and ``tick(reading)`` as `Walker`, which sees sensor readings
only (the default, and the only kind, in MuJoCo).

In either engine it may also be a plain function of (t, q, v) that returns torques by joint name
(`frontal_biped.control.joint_law`); an answer that is none is refused in one line.

``space = true`` walks the whole robot, every joint free, in MuJoCo (`frontal_biped.scenarios.space_file` has the keys
that it adds): a speed that changes, pushes in any direction on any link, errors of every body. A controller of your own
has ``reset(stance, q, v)``, ``tick(reading)`` and ``command(...)`` as `SpatialWalker`, or is such a function of every
joint.

Our simulator's feet are rigid. Where the ground reaction or the impulse of a landing leaves the friction cone the foot
cannot stay, and the run ends there ("slipped"); without ``friction`` it sticks whatever is asked of it. A foot that
lands on its edge settles flat at once up to ``flat_landing`` (0.02 rad), and beyond that has stumbled.
"""

from frontal_biped.scenarios.file import load_scenario
from frontal_biped.scenarios.monte_carlo import ScenarioResult, Survival, run_trials, survival
from frontal_biped.scenarios.run import TrialResult, run_scenario
from frontal_biped.scenarios.scenario import Expectations, Scenario

__all__ = [
    "Expectations",
    "Scenario",
    "ScenarioResult",
    "Survival",
    "TrialResult",
    "load_scenario",
    "run_scenario",
    "run_trials",
    "survival",
]
