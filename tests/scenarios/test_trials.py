"""Trials: judged by physics, repeatable whatever the executor, and by controllers of one's own."""

import json
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.cli import main
from frontal_biped.control import QpController
from frontal_biped.library import worker_processes
from frontal_biped.scenarios import load_scenario, run_scenario, run_trials, survival
from frontal_biped.scenarios.report import table, verdict
from frontal_biped.simulation import load_trajectory
from frontal_biped.simulation.hybrid_system import EventKind

NOISY = """
gait = "robust"
steps = 1
controller = {type = "qp", stabiliser = "adaptive"}
[disturbances]
encoder_noise = 1e-4
torque_noise = 0.01
[model]
mass = {within = 0.05}
"""

SHORT = """gait = "robust"
steps = 1
controller = {type = "qp", stabiliser = "adaptive"}
"""

OWN = """
from frontal_biped.control import QpController


class Limp:
    def __init__(self, biped, gait, period):
        self.inner = QpController(biped, gait)

    def begin(self, phase, q, dq):
        self.inner.begin(phase, q, dq)

    def command(self, phase, q, dq):
        command = self.inner.command(phase, q, dq)
        return command._replace(u=0.0 * command.u)


def make(biped, gait, period, share=1.0):
    assert share == 0.5
    return QpController(biped, gait)
"""


@pytest.fixture
def noisy(write):
    return load_scenario(write(NOISY, "noisy.scenario.toml"))


def outcome(results):
    """Every digit of every trial; as text, in which nan equals nan."""
    return [[repr((trial.measured, trial.drawn, trial.outcome)) for trial in result.results] for result in results]


@pytest.mark.slow
def test_threads_give_the_numbers_of_one_process(noisy):
    noisy = replace(noisy, speed_error=0.003)  # what is run is the scenario given, not what its file says
    alone = run_trials([noisy], repeat=3, seed=4)
    with ThreadPoolExecutor(2) as executor:
        threads = run_trials([noisy], repeat=3, seed=4, executor=executor)
    assert outcome(alone) == outcome(threads)
    assert len(set(outcome(alone)[0])) == 3
    assert outcome(run_trials([noisy], seed=4, numbers=[2]))[0] == outcome(alone)[0][2:]


@pytest.mark.slow
def test_processes_give_the_numbers_of_one_process(noisy):
    alone = run_trials([noisy], repeat=4, seed=4)
    with worker_processes(2) as executor:
        assert outcome(run_trials([noisy], repeat=4, seed=4, executor=executor)) == outcome(alone)


def test_survival_interval_is_wilsons():
    """Against the formula: centre (p + z^2/2n) / (1 + z^2/n), half-width z sqrt(p(1-p)/n + z^2/4n^2) / (1 + z^2/n)."""
    z = 1.959963984540054
    for passed, n in ((95, 100), (100, 100), (0, 7), (3, 10)):
        p, found = passed / n, survival(passed, n)
        centre = (p + z**2 / (2 * n)) / (1 + z**2 / n)
        half = z * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2)) / (1 + z**2 / n)
        assert found.low == pytest.approx(max(0.0, centre - half), abs=1e-9)
        assert found.high == pytest.approx(min(1.0, centre + half), abs=1e-9)
    assert survival(100, 100).low < 0.97  # a hundred of a hundred is no proof


def test_push_at_a_reversal_begins_there_and_gives_its_impulse(write):
    """Two runs that differ by the push alone: the same up to the reversal, not after."""
    text = 'gait = "robust"\nsteps = 2\ncontroller = {type = "qp", stabiliser = "adaptive"}\n'
    plain = run_scenario(load_scenario(write(text, "plain.scenario.toml"))).run
    push = '[[push]]\nat = "reversal of step 2"\nimpulse = 2.0\nduration = 0.02\n'
    pushed = run_scenario(load_scenario(write(text + push, "pushed.scenario.toml"))).run
    reversal = pushed.event_t[pushed.events("REVERSAL")[1]]
    same = np.searchsorted(pushed.t, reversal)
    assert np.array_equal(plain.q[:same], pushed.q[:same])
    # 10 ms after the push has ended the post-reversal states are apart
    later = np.searchsorted(pushed.t, reversal + 0.03)
    assert np.max(np.abs(plain.dq[later] - pushed.dq[later])) > 1e-2


def test_slippery_ground_is_an_outcome(write):
    """The robust gait needs a friction of about 0.1, and cannot walk on half of that."""
    text = (
        'gait = "robust"\nsteps = 2\ncontroller = {type = "qp", stabiliser = "adaptive"}\n[disturbances]\nfriction = '
    )
    result = run_scenario(load_scenario(write(text + "0.05")))
    assert not result.passed
    assert "slipped" in result.outcome
    assert "slipped" in str(result)
    needed = result.measured["friction"]
    assert needed > 0.05
    assert run_scenario(load_scenario(write(text + "0.6", "sticky.scenario.toml"))).passed


def test_weak_motors_saturate(write):
    text = SHORT + "[disturbances]\ntorque_limits = [10.0, 40.0]\n"
    run = run_scenario(load_scenario(write(text))).run
    assert np.all(np.abs(run.u) <= np.array([10.0, 40.0, 40.0, 10.0]))
    assert np.max(np.abs(run.u[:, 1])) == 40.0


def test_torques_come_late(write):
    """A delay of five ticks: what is applied at the first six ticks is the first command, over and over."""
    text = 'gait = "robust"\nsteps = 1\ncontroller = {period = 0.01}\n[disturbances]\ndelay = 0.05\n'
    run = run_scenario(load_scenario(write(text))).run
    assert np.allclose(run.u[run.t < 0.0599], run.u[0])
    assert not np.allclose(run.u[np.searchsorted(run.t, 0.061)], run.u[0])


def test_step_up_is_met_early_and_step_down_late(write):
    times = []
    for i, height in enumerate((0.002, 0.0, -0.002)):
        text = SHORT + f"flat_landing = 0.2\n[disturbances]\nground = [{height}]\n"
        times.append(run_scenario(load_scenario(write(text, f"ground{i}.scenario.toml"))).run.event_t[-1])
    assert times[0] < times[1] < times[2]


def test_controllers_of_ones_own(write, tmp_path):
    (tmp_path / "mine_for_tests.py").write_text(OWN, encoding="utf-8")
    head = 'gait = "robust"\nsteps = 1\n[controller]\ntype = "mine_for_tests:{}"\n'
    assert run_scenario(load_scenario(write(head.format("make") + "arguments = {share = 0.5}\n"))).passed
    limp = run_scenario(load_scenario(write(head.format("Limp"), "limp.scenario.toml")))
    assert not limp.passed
    assert "walked 0 of 1 step, then it fell" in str(limp)
    given = run_scenario(
        load_scenario(write("steps = 1\ngait = 'robust'")), controller=lambda b, g, period: QpController(b, g)
    )
    assert given.passed


def test_command_line_saves_reports_and_returns_1(write, tmp_path, capsys):
    path = write(NOISY + "[expect]\noutput_error = 1e-7\n", "noisy.scenario.toml")
    junit, runs = tmp_path / "junit.xml", tmp_path / "runs"
    assert main(["trial", str(path), "--repeat", "2", "--junit", str(junit), "--save", str(runs), "--json"]) == 1
    table = json.loads(capsys.readouterr().out)
    assert not table["passed"]
    trials = table["scenarios"][0]["trials"]
    assert [trial["passed"] for trial in trials] == [False, False]
    cases = ElementTree.parse(junit).getroot().findall("testsuite/testcase")
    assert [case.find("failure").get("message") for case in cases] == [
        next(f["text"] for f in trial["findings"] if not f["held"]) for trial in trials
    ]
    for number in range(2):
        run = load_trajectory(runs / f"noisy-{number}.npz")
        assert run.settings["trial"]["trial"] == number
        assert run.settings["errors"]["mass"] != [1.0] * 5
    # the same file is as expected when a share of the trials is allowed to fail
    scenario = load_scenario(path)
    lenient = replace(scenario, expect=replace(scenario.expect, survival=0.0))
    assert run_trials([lenient])[0].passed


def test_command_line_returns_0_and_the_verdict_leads(write, capsys):
    assert main(["trial", str(write(SHORT)), "-v"]) == 0
    out, _, rows = capsys.readouterr().out.partition("\n\n")
    reached, tightest, motors = out.splitlines()
    assert reached == "as expected: 1 scenario, 1 of 1 trials passed"
    assert tightest.startswith("tightest  torque ") and tightest.endswith(
        " % of the limit, in case"
    )  # nothing is bounded
    assert motors.startswith("motors    torque ")
    lines = rows.splitlines()
    assert lines[0].startswith("scenario")
    assert lines[-1].startswith("case")
    assert lines[-1].endswith("as expected")


def test_the_verdict_says_what_failed_and_which_bound_was_nearest(write):
    text = SHORT + "[expect]\noutput_error = 1e-9\ntorque = 0.9\n"
    (result,) = run_trials([load_scenario(write(text))])
    reached, tightest, motors = verdict([result]).splitlines()
    (failure,) = result.results[0].failures
    assert reached == f"FAILED: 1 of 1 scenario: case, trial 0 of seed {result.results[0].seed}: {failure.text}"
    error, torque = (result.results[0].measured[key] for key in ("output_error", "torque"))
    assert tightest.startswith(f"tightest  largest output error {error:.3g} of 1e-09 rad, {error / 1e-11:.0f} %")
    assert motors == f"motors    torque {100.0 * torque:.0f} % of the limit, in case"
    half = replace(result, results=(*result.results, replace(result.results[0], findings=())))
    assert verdict([half, half]).startswith(
        "FAILED: 2 of 2 scenarios: case, 1 of 2 trials, the first of them trial 0 of"
    )


ROLLING = """gait = "robust"
steps = 1
controller = {type = "qp", stabiliser = "ankle"}
[[push]]
at = "2 % of the rising phase of step 1"
impulse = 16.0
"""


def test_a_push_trial_tells_where_the_fri_was_and_may_let_the_foot_roll(write):
    """A foot that sticks walks on; the table says how far the FRI was outside."""
    stuck, rolled = (
        run_trials([load_scenario(write(ROLLING + more))])[0] for more in ("", "[disturbances]\nrolls = true\n")
    )
    assert stuck.passed
    assert stuck.least("fri_margin") < -1e-3
    row = table([stuck]).splitlines()[2].split()
    assert f"{1e3 * stuck.least('fri_margin'):.3g}" in row
    assert not rolled.passed
    assert rolled.results[0].outcome == EventKind.ROLLED.value
