"""Frontal-plane bipedal hybrid zero dynamics on Pinocchio: design, certify, control, simulate and watch gaits.

    import frontal_biped as fb

    robot = fb.load_robot("frontal_biped")
    result = fb.design_gait(robot, fb.GaitSpecification())
    print(fb.analyze(robot, result.gait))
    run = fb.simulate(robot, result, steps=20)
    fb.view(run)  # in a notebook: the page of the run; robots, gaits and runs show themselves as well

Where a robot or a gait is taken, so is its name or the path of its file: ``fb.simulate("g1", "g1")``.

Rooms, each may use those before it: `frontal_biped.files` and `frontal_biped.numerics`, without mechanics;
`frontal_biped.model`, the robot; `frontal_biped.virtual_constraints`; `frontal_biped.zero_dynamics`;
`frontal_biped.gait`, with specification and file; `frontal_biped.control`; `frontal_biped.simulation`; then, beside
each other, `frontal_biped.design`, `frontal_biped.analysis` and `frontal_biped.viewer`; and what is built on these,
`frontal_biped.library`, `frontal_biped.scenarios`, `frontal_biped.figures`, `frontal_biped.studio`,
`frontal_biped.demo` and `frontal_biped.cli`.

Names are imported when first used, so that `frontal-biped --help` does not wait for Pinocchio.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from frontal_biped.exceptions import FrontalBipedError
from frontal_biped.version import __version__

if TYPE_CHECKING:
    from frontal_biped.analysis.closed_form import GaitAnalysis, analyze
    from frontal_biped.analysis.proof import ProofCertificate, prove, verify
    from frontal_biped.design.optimise import DesignResult
    from frontal_biped.design.walking_gait import design_gait
    from frontal_biped.gait.file import load_gait, save_gait
    from frontal_biped.gait.gait import Gait
    from frontal_biped.gait.shipped import load_specification
    from frontal_biped.gait.specification import GaitSpecification, read_specification
    from frontal_biped.model.biped import FrontalBiped
    from frontal_biped.model.catalogue import load_robot, robot_names
    from frontal_biped.scenarios.file import load_scenario
    from frontal_biped.scenarios.monte_carlo import run_trials
    from frontal_biped.scenarios.run import TrialResult, run_scenario
    from frontal_biped.scenarios.scenario import Scenario
    from frontal_biped.simulation.space.run import SpatialRun, load_spatial_run, save_spatial_run
    from frontal_biped.simulation.space.walk_path import walk_path
    from frontal_biped.simulation.space.walk_spatial import walk_spatial
    from frontal_biped.simulation.trajectory import Trajectory, load_trajectory, save_trajectory
    from frontal_biped.simulation.walking import simulate
    from frontal_biped.simulation.whole_robot import whole_motion
    from frontal_biped.viewer.view import View, view

__docformat__ = "google"

__all__ = [
    "DesignResult",
    "FrontalBiped",
    "FrontalBipedError",
    "Gait",
    "GaitAnalysis",
    "GaitSpecification",
    "ProofCertificate",
    "Scenario",
    "SpatialRun",
    "Trajectory",
    "TrialResult",
    "View",
    "__version__",
    "analyze",
    "design_gait",
    "load_gait",
    "load_robot",
    "load_scenario",
    "load_specification",
    "load_spatial_run",
    "load_trajectory",
    "prove",
    "read_specification",
    "robot_names",
    "run_scenario",
    "run_trials",
    "save_gait",
    "save_spatial_run",
    "save_trajectory",
    "simulate",
    "verify",
    "view",
    "walk_path",
    "walk_spatial",
    "whole_motion",
]

_HOME = {
    "DesignResult": "design",
    "FrontalBiped": "model",
    "Gait": "gait",
    "GaitAnalysis": "analysis",
    "GaitSpecification": "gait",
    "ProofCertificate": "analysis.proof",
    "Scenario": "scenarios",
    "SpatialRun": "simulation",
    "Trajectory": "simulation",
    "TrialResult": "scenarios",
    "View": "viewer",
    "analyze": "analysis",
    "design_gait": "design",
    "load_gait": "gait",
    "load_robot": "model",
    "load_scenario": "scenarios",
    "load_specification": "gait",
    "load_spatial_run": "simulation",
    "load_trajectory": "simulation",
    "prove": "analysis.proof",
    "read_specification": "gait",
    "robot_names": "model",
    "run_scenario": "scenarios",
    "run_trials": "scenarios",
    "save_gait": "gait",
    "save_spatial_run": "simulation",
    "save_trajectory": "simulation",
    "simulate": "simulation",
    "verify": "analysis.proof",
    "view": "viewer",
    "walk_path": "simulation",
    "walk_spatial": "simulation",
    "whole_motion": "simulation",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value  # asked for once; and pdoc looks into the module's dictionary
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
