"""What is verified and how; and the robots, independently computed numbers and designed gaits that the tests share.

Each claim, how it is held, what was measured, and the tests that hold it:

* Dynamics, ground reaction, momentum, impact, kappa_1..3: against numbers of a separately written symbolic model, three
  robots; relative 1e-9. model/test_independent_values.py, zero_dynamics/test_restricted.py
* Planar models of fourteen robots, either foot: inverse dynamics against the 3D model moved in the plane, pinned
  against projected floating model, impact against its KKT system; relative 1e-10 (icub 1e-5: its URDF is rounded).
  model/test_every_robot.py, robot_laws.py, model/test_stance_map.py
* The planar gait in space: what the ground must hold, against inverse dynamics and momenta of seven humanoids in space
  and of three with every joint free, 1e-9 (icub 1e-5; virtual legs of g1_bent 1e-2); landing with every joint free
  against the planar impact in the limit, 1e-9; energy of a step read from the free robot against the orbit's, 1e-9.
  gait/test_holding_wrench.py, model/space/test_landing.py, zero_dynamics/test_frontal_energy.py
* Virtual legs: Jacobians and drifts against differences, 1e-7; (y, z) of hips, ankles and trunk wherever the feet are
  in x, 1e-9. model/space/test_space_state.py
* The whole-body program: in the plane the torques of the planar one, romeo_bent 1e-8; 1000 adversarial states each of
  three robots, optimal under active limits by conditions that other code checks; what ProxQP finds, where it finds it
  and no limit gives way; what gives way; soles and joint ranges. control/whole_body/test_whole_body_program.py,
  control/whole_body/test_whole_body_rows.py, control/whole_body/test_contact_and_ranges.py
* The sagittal law on the linear inverted pendulum: reference, feedback, foothold; 1e-9 m of an ODE solver.
  control/spatial_walker/test_sagittal_law.py
* Over the sway: the planned poses, 1e-4 rad, wherever a phase begins; the sway of the free robot is that of the planar
  centre of mass. virtual_constraints/test_swayed.py, model/space/test_space_state.py
* The walker in space by itself: base from a foot at rest, 1e-9; time to landing against the orbit, and against the full
  planar model from 1 % off its speed, 3 % of a step; a rigid foot without a simulator, step time within 5 %.
  control/spatial_walker/test_spatial_estimator.py, zero_dynamics/test_sway_orbit.py,
  control/spatial_walker/test_spatial_walker.py
* Walks in MuJoCo with every joint free: five robots four or six steps on the spot, step time within 1 %; talos_full ten
  steps at 0.2 m/s, with noise and 3 ms of delay too, step time within 2 %, speed within 10 %.
  simulation/space/test_walk_spatial.py
* Looking ahead: the table's answers are the computed ones, 1000 speeds over the basin, basin unchanged.
  Compiled ticks are the exact solver's. Continuous walks by collocation and by DOP853 are the same motion within the
  tolerances. control/stabilisers/test_tabulation.py, control/torques/test_few_rows.py, simulation/test_continuous.py
* Proofs in ball arithmetic: of 1000 states each of seven robots the balls contain Pinocchio's forces, FRI, mass matrix
  and impact; decimals of URDFs against the reduction in floating point; models against balls at points. Seven gaits:
  numbers of zeros, multiplier, contraction, C01 to C09 as measured, and basins inside the measured ones. Polynomials
  with known roots, double zeros, zeros at an end. 200 random parameter sets against the measured certificate and a scan
  in fifty digits. zero_dynamics/proof, analysis/test_proof.py, analysis/test_statements.py, proof_campaign.py
* Two steps in turn: the map of both in closed form against the full model, three travels, two robots, relative 1e-5,
  multiplier 1e-4; two equal steps give the numbers of one; the pair of reversals by elimination and by Newton's method;
  `travel = 0.1` of the Table I robot certified, 50 steps in both engines. zero_dynamics/test_two_steps.py,
  zero_dynamics/reversal/test_two_reversals.py, gait/test_sideways_gait.py, design/test_sideways_design.py
* Double support: torques to motion and both wrenches against the contact dynamics of the floating robot, 1e-9; power
  against energy; least and greatest acceleration against programs of their own; no impulse at the landing.
  zero_dynamics/test_support_dynamics.py, zero_dynamics/test_support_plan.py, gait/test_support_gait.py
* Stand, set off, walk, stop, stand, in both engines, three robots: first lift-off within 5 % of the orbit's speed, an
  error of 10 % below 1 % after a step, at rest within two landings. Files of such gaits are strict, written again byte
  for byte, and refuted where their numbers are not the orbit's. simulation/test_support_walk.py,
  gait/test_support_file.py, cli/test_double_support_commands.py
* In space along a path: words, poses, plans of steps, stands and both feet each by itself; talos_full along paths,
  where it ends in truth and by odometry. control/path/test_path_language.py, control/path/test_path_follower.py,
  control/spatial_walker/test_step_plan.py, control/spatial_walker/test_standing.py,
  control/whole_body/test_both_feet.py, control/test_landing_widths.py, simulation/space/test_walk_path.py
* The studio's steered walk: an order is followed from the next step on, in the browser too; its nodes stand where
  Pinocchio has the bodies, 1e-9; its process ends with its parent. studio/test_app.py, studio/test_driver.py,
  studio/test_space_drawing.py, simulation/space/test_steered.py
* A URDF is read as it is written, in all the ways that one small humanoid can be: mass and inertia of every body equal
  the text's; a posture keeps the angles it is given. model/urdf/test_same_robot.py
* A gait is called one when it walks: what governs a fall is tightened, within a budget; the gait `rough` 20 steps in
  both engines, speed within 2 %, step time within 1 %. design/test_walking_gait.py
* The walker over the sway: residuals of its targets by inverse dynamics, 1e-9; optimal by ProxQP where limits are
  active. control/torques/test_linearisation.py. The law itself: control/test_frontal_law.py
* Design, analyze, certificate, report and studio never contradict each other, near close pairs of zeros too.
  gait/test_gait_verdict.py, zero_dynamics/reversal/test_planned.py, numerics/test_chebyshev.py
* A start that keeps every bound survives the optimiser; what the peer finds is found. design/test_never_lost.py
* The whole robot of a planar motion: stance foot at rest 1e-9, swing foot as in the plane, velocities as rates of the
  pose, inverse dynamics balance within 1e-3 of the weight, MuJoCo's bodies where Pinocchio has them 1e-9; three robots.
  simulation/test_whole_robot.py, simulation/test_whole_files.py
* Own controllers: a gait replayed by joint name walks a step, step time within 2 %; wrong answers in one line.
  control/test_joint_law.py, simulation/test_own_controllers.py
* Changed robots, names and results where robots and gaits are taken, what a notebook shows.
  model/test_changed_robots.py, gait/test_given.py, files/test_shown.py, viewer/test_view.py, figures/test_plot.py
* A gait or run finds its robot wherever the two are moved together. gait/test_robot_path.py
* A robot's page: every link where Pinocchio has it after moving every slider, two robots, 2e-5 m.
  viewer/test_joints_page.py
* Pages do not scroll sideways at 400 px, the legend is below the picture, dark reaches plots and sky, spikes are
  clipped; light meshes without debris; steps counted once. viewer/test_page_widths.py, viewer/test_robot_meshes.py,
  viewer/test_pages.py
* Every help example runs as printed; every option that writes checks its name, and nothing that is read is written
  over. cli/test_help_examples.py, cli/test_arguments.py, cli/test_output.py
* Cost of the reference and level-pelvis gaits: from the default start, checked on a grid 40 times denser than the
  optimiser's; 210.2 and 405.6 N^2 m s. design/test_design.py
* Hybrid invariance and energy balance of a gait file: residuals below 1e-9. design/test_design.py, gait/test_gait.py
* zeta(beta): quadrature against an ODE solver at rtol 1e-12; error with 8, 16, 24, 32 nodes 1e-3, 2e-7, 3e-11, 3e-15.
  zero_dynamics/test_restricted.py
* Full model, continuous control, 20 steps: worst post-impact state off by less than 1e-7. simulation/test_walking.py
* Multiplier: closed form against the simulated return map, relative 1e-4. zero_dynamics/test_poincare.py,
  simulation/test_walking.py
* Contraction of the successive approximation: predicted against measured, relative 1e-3.
  zero_dynamics/reversal/test_solver.py
* Zeros of Z and S on the regular region of the bracket (`zero_dynamics.reversal.certificate` says which it is): against
  a dense grid. Newton's method from REVERSAL_SETS=200 random parameter sets: 4 steps (median), 7 at most; on every
  tenth set, and wherever it finds nothing, all zeros are counted. The paper's iteration, on every fifth: 38 steps
  (median), fails on 4 %. zero_dynamics/reversal/test_solver.py
* Invariance under re-anchoring: full model, reversal errors of 1e-7 to 1e-2 rad, early and late; below 1e-8 rad. At
  2e-2 rad a late one on the gait with the pelvis within 5 degrees overloads the robot and loses 2e-3 rad, which is why
  `adaptive` looks ahead. analysis/test_sensitivity.py
* Restricted map with a variable reversal: against two steps of the full model under continuous control, six stabiliser
  and gait pairs; and one step from each of twelve speeds, end to end of the intervals that return, `adaptive` and
  `ankle`; relative 1e-5. analysis/test_return_map.py
* Looking ahead: full model under the quadratic program, continuous control, from -5 and +25 % (reference), -20 and
  +50 % (pelvis within 5 degrees); every limit kept, invariance below 1e-6 rad, each step nearer, each as the map says.
  control/stabilisers/test_look_ahead.py
* A-frame rocker, rocking block, inverted pendulum: published closed forms, as limits; 1e-9, or the order of the limit.
  zero_dynamics/test_closed_forms.py
* Full model, torques held for 1 ms: worst output error over 20 steps 1.2e-3 rad, of order 1 in the period at equal
  gains. simulation/test_walking.py
* Gait `robust`, torques held for 1 ms, torque noise of 1 % and encoder noise of 1e-4 rad: 200 steps, no fall.
  simulation/test_disturbances.py
* Seven humanoids, torques held for 1 ms, reversal-adaptive, error dynamics of 200 rad/s: 20 steps, no fall.
  model/test_regression_gaits.py
* Bent knees: room for the step by the law of cosines, flat feet by the lowest points of the soles, static torque of a
  knee by weight and lever; virtual legs: no link moves at the posture, and each turns about X as Rodrigues' formula
  says. model/urdf/test_bent_posture.py, model/urdf/test_virtual_legs.py
* A bare URDF, described, bent, measured, kept, found again and never written over; tilted hips and legs mirrored only
  nearly. design/test_preparation.py
* The whole robot in MuJoCo: mass matrix and bias of seven robots against Pinocchio, relative 1e-10, with Romeo's
  impossible inertias mended alike in both; weight, momentum, friction cone, impulses of pushes, and motors that keep
  torque and speed limits, each by Pinocchio or by hand. simulation/mujoco/test_space_model.py,
  simulation/mujoco/test_space_robot.py
* The start of a walk in space: the planar state, feet flat and at rest, by forward kinematics; 1e-11.
  simulation/space/test_spatial_start.py
* The quadratic program: 1000 adversarial states; KKT conditions checked by other code, infeasibility by a linear
  program. control/torques/test_torque_program.py
* The studio: newest request wins, a refused specification keeps the last gait, no process or port stays; in Chromium
  slider, push, save, no request, no console error. studio/test_workbench.py, studio/test_worker.py, studio/test_app.py
* The page, four robots, in headless Chromium with mouse and keyboard: no request, no console message; play, pause,
  slider, marks, every toggle, cursors, dragging in plots, speed, keys; feet on the ground.
  viewer/test_page_in_browser.py
* The page of a walk in space, two robots, in headless Chromium: every link within 2e-5 m of Pinocchio's forward
  kinematics; markers, footsteps, camera, toggles, plots; no request, no console message.
  viewer/test_space_page_in_browser.py
* Walks in space exported for Pinocchio and MuJoCo: there and back, and both engines, each reading the URDF itself, have
  every link at one place and speed, five robots; 1e-12. model/space/test_joint_arrays.py
* The live viewer: ended by Ctrl+C, SIGTERM, SIGKILL, with browsers open, vanished and stalled; no process left, port
  free. viewer/test_live.py
* Figures: width, size and overlap of all letters; 3.5 in, 8 pt, none. figures/test_figures.py
* Every malformed input: one line, exit status, nothing written. cli/test_main.py, model/urdf/test_unsuitable_robots.py,
  model/urdf/test_malformed_urdfs.py, gait/test_malformed_gaits.py, scenarios/test_malformed.py, library/test_sweep.py,
  files/test_toml.py, files/test_reading.py
* Run files with every array, header entry and byte spoilt: refused in one line, or loaded as they were; odd ones
  through every command. simulation/test_malformed_runs.py, cli/test_odd_runs.py
* Every command on files spoilt at random and with senseless options: no traceback, one line, nothing half-written, a
  thousand cases. cli/test_fuzz.py; as many as wanted: fuzz_campaign.py; readers by coverage: fuzz_readers.py
* Killed at moments seen to lie inside a write: nothing half-written, nothing lost, a library resumes byte for byte.
  cli/test_killed.py, kill_campaign.py
* Bad surroundings, full disks, closed streams, no home: one line that names the file. cli/test_surroundings.py,
  files/test_atomic.py
* A library's files are of its robots and points. library/test_store.py
* What a user's controller raises or answers: one line. scenarios/test_user_code.py
* Foreign pages, wrong hosts, origins and secrets get nothing and change nothing, by raw requests and in Chromium.
  viewer/test_guard.py, viewer/test_live_is_private.py, studio/test_closed_server.py, studio/test_app.py
* Meshes outside the robot's folders, and broken ones, are refused. model/urdf/test_meshes.py
* Searches for pushes let the foot slip and roll. analysis/test_push_recovery.py. A long walk costs its samples; a page
  of 1000 steps is small, and as fast as one of four within a factor. simulation/test_rows.py, viewer/test_long_pages.py
* What examples and notebooks print: each against its docstring or its stored output, words alike, numbers within 2 %.
  test_examples.py. From an installed wheel in another folder, with every command that the README names: smoke.py
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from robot_files import write_robot

from frontal_biped.design import DesignResult, optimise_gait
from frontal_biped.gait import Gait, GaitSpecification, load_gait, load_specification
from frontal_biped.model import FrontalBiped, load_robot
from frontal_biped.simulation import Trajectory, orbit_trajectory, simulate

# Fixtures are expensive and read-only; a slow machine is no failure; the same examples in every run.
settings.register_profile("physics", max_examples=25, deadline=None, derandomize=True)
settings.load_profile("physics")

ROBOTS = ("table1", "table1_low_torso", "raised_ankle")
"""Robots of data/independent_values.json: Table I, its literal torso, one with raised and offset feet."""

_INDEPENDENT = json.loads((Path(__file__).parent / "data" / "independent_values.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def independent() -> Mapping[str, Any]:
    """Numbers of a separately written symbolic model, by robot."""
    return _INDEPENDENT["robots"]


@pytest.fixture(scope="session")
def biped() -> FrontalBiped:
    return load_robot("frontal_biped")


@pytest.fixture(scope="session")
def low_torso() -> FrontalBiped:
    return load_robot("frontal_biped_low_torso")


@pytest.fixture(scope="session")
def raised_ankle(tmp_path_factory: pytest.TempPathFactory, independent: Mapping[str, Any]) -> FrontalBiped:
    folder = tmp_path_factory.mktemp("raised_ankle")
    return load_robot(write_robot(folder, "raised_ankle", independent["raised_ankle"]["parameters"]))


@pytest.fixture(scope="session")
def robots(biped: FrontalBiped, low_torso: FrontalBiped, raised_ankle: FrontalBiped) -> Mapping[str, FrontalBiped]:
    """The three robots under the names of the independent numbers."""
    return dict(zip(ROBOTS, (biped, low_torso, raised_ankle), strict=True))


@pytest.fixture(scope="session", params=ROBOTS)
def robot_name(request: pytest.FixtureRequest) -> str:
    """Runs a test once for each robot."""
    return str(request.param)


@pytest.fixture(scope="session")
def robot(robots: Mapping[str, FrontalBiped], robot_name: str) -> FrontalBiped:
    return robots[robot_name]


@pytest.fixture(scope="session")
def reference_design(biped: FrontalBiped) -> DesignResult:
    """Gait design with every specification at its default."""
    return optimise_gait(biped, GaitSpecification())


@pytest.fixture(scope="session")
def level_design(biped: FrontalBiped) -> DesignResult:
    """The same with the pelvis level to five degrees."""
    return optimise_gait(biped, GaitSpecification(max_pelvis_roll=float(np.radians(5.0))))


@pytest.fixture(scope="session")
def reference_gait(reference_design: DesignResult) -> Gait:
    assert reference_design.gait is not None, reference_design.message
    return reference_design.gait


@pytest.fixture(scope="session")
def reference_certificate(biped, reference_gait):
    """Of the reference gait, without stretched phases in the basin of the ankle law: they take longest."""
    from frontal_biped.analysis.proof import prove

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("frontal_biped.zero_dynamics.proof.ankle_basin.MOST_STRETCHES", 0)
        return prove(biped, reference_gait)


@pytest.fixture(scope="session")
def level_gait(level_design: DesignResult) -> Gait:
    assert level_design.gait is not None, level_design.message
    return level_design.gait


@pytest.fixture(scope="session")
def robust_gait(biped: FrontalBiped) -> Gait:
    """The gait of the shipped specification `robust`."""
    result = optimise_gait(biped, load_specification("robust"))
    assert result.gait is not None, result.message
    return result.gait


# ---------------------------------------------------------------------- a run to draw
@pytest.fixture(scope="session")
def gait() -> Gait:
    """Stored, so that these tests wait for no optimiser; nothing here depends on its quality."""
    return load_gait(Path(__file__).parent / "data" / "gait.json")


@pytest.fixture(scope="session")
def orbit(biped: FrontalBiped, gait: Gait) -> Trajectory:
    return orbit_trajectory(biped, gait)


@pytest.fixture(scope="session")
def walk(biped: FrontalBiped, gait: Gait) -> Trajectory:
    run = simulate(biped, gait, steps=4, period=None)
    assert not run.fell
    return run


@pytest.fixture(scope="session", params=["orbit", "walk"])
def trajectory(request: pytest.FixtureRequest, orbit: Trajectory, walk: Trajectory) -> Trajectory:
    """The orbit in closed form, then the simulated walk."""
    return {"orbit": orbit, "walk": walk}[request.param]
