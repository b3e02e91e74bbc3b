"""Scenarios: scripted trials of a controller, in our simulator or in MuJoCo, with expectations."""

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
