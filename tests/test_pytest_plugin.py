"""The pytest plugin, from outside: ordinary runs are left alone, scenarios are tests where asked for, failures are
readable."""

import pytest

pytest_plugins = ["pytester"]

GOOD = 'gait = "robust"\nsteps = 1\ncontroller = {type = "qp", stabiliser = "adaptive"}\n'
BAD = GOOD + "[expect]\noutput_error = 1e-9\n"
STRICT = ("-p", "no:cacheprovider", "-W", "error", "--strict-markers", "-n", "0")


@pytest.fixture
def outside(pytester, monkeypatch):
    """A project that knows nothing of this one's settings, but that its scenarios are tests."""
    monkeypatch.setenv("PYTEST_ADDOPTS", "")
    pytester.makeini("[pytest]\nfrontal_biped_scenarios = true\n")
    return pytester


@pytest.fixture
def strangers(outside):
    """A project that has never heard of the plugin; its scenario would run a module that leaves a trace."""
    outside.makeini("[pytest]\n")
    outside.makefile(".scenario.toml", theirs='steps = 1\ncontroller = "trace:make"\n')
    outside.makepyfile(trace="from pathlib import Path\nPath('trace').touch()\n", test_own="def test_own(): pass")
    return outside


def test_a_project_that_does_not_ask_is_left_alone(strangers):
    strangers.runpytest_subprocess(*STRICT).assert_outcomes(passed=1)
    strangers.runpytest_subprocess(*STRICT, ".").assert_outcomes(passed=1)
    assert not (strangers.path / "trace").exists()


@pytest.mark.slow
@pytest.mark.parametrize("asked", [("--scenarios",), ("theirs.scenario.toml",), ("-o", "frontal_biped_scenarios=yes")])
def test_it_may_be_asked_for_on_the_command_line(strangers, asked):
    """The module is imported, and has no factory."""
    run = strangers.runpytest_subprocess(*STRICT, *asked)
    assert run.parseoutcomes()["failed"] == 1
    run.stdout.fnmatch_lines(["*theirs.scenario.toml: controller = 'trace:make': module 'trace' has no 'make'*"])


def test_it_can_be_left_out(strangers):
    strangers.runpytest_subprocess(*STRICT, "-p", "no:frontal_biped").assert_outcomes(passed=1)


def test_ordinary_run_imports_neither_pinocchio_nor_numpy(outside):
    outside.makepyfile(
        """
        import sys

        def test_light():
            assert "frontal_biped.pytest_plugin" in sys.modules
            heavy = {"pinocchio", "numpy", "scipy", "proxsuite", "mujoco", "frontal_biped.model"}
            assert not heavy & set(sys.modules)
        """
    )
    outside.makefile(".toml", ordinary="a = 1")
    outside.runpytest_subprocess(*STRICT).assert_outcomes(passed=1)


def test_scenarios_are_tests_and_failures_are_told_without_a_traceback(outside):
    outside.makefile(".scenario.toml", good=GOOD, bad=BAD, wrong="stepz = 1", lazy=GOOD + "slow = true\n")
    run = outside.runpytest_subprocess(*STRICT, "-m", "not slow", "--scenario-save", "runs")
    run.assert_outcomes(passed=1, failed=2, deselected=1)
    text = run.stdout.str()
    assert "Traceback" not in text
    assert ".py:" not in text
    run.stdout.fnmatch_lines(
        [
            "bad.scenario.toml: 0 of 1 trials passed, expected all",
            "bad (ours), trial 0 of seed 0",
            "  FAILED  largest output error * (at most 1e-09 rad)",
            "again, and to be watched: frontal-biped trial *bad.scenario.toml --seed 0 --only 0 --save runs",
            "*wrong.scenario.toml: unknown key 'stepz'; did you mean 'steps'?",
        ]
    )
    assert (outside.path / "runs" / "good-0.npz").is_file()


@pytest.mark.slow
def test_fixture_runs_a_controller_of_ones_own(outside):
    outside.makefile(".scenario.toml", good=GOOD, bad=BAD)
    outside.makepyfile(
        """
        from frontal_biped.control import QpController

        def test_mine(trial):
            made = []

            def factory(robot, gait, period):
                made.append(QpController(robot, gait))
                return made[-1]

            result = trial("good.scenario.toml", controller=factory)
            assert made[0].ticks > 300
            assert result.measured["torque"] < 1.0

        def test_expectations_are_checked(trial):
            trial("bad.scenario.toml")

        def test_unless_told_otherwise(trial):
            assert not trial("bad.scenario.toml", check=False).passed
        """
    )
    run = outside.runpytest_subprocess(*STRICT, "test_fixture_runs_a_controller_of_ones_own.py")
    run.assert_outcomes(passed=2, failed=1)
    run.stdout.fnmatch_lines(["*FAILED  largest output error*"])


@pytest.mark.slow
def test_processes_of_xdist_share_the_scenarios(outside):
    outside.makefile(".scenario.toml", one=GOOD, two=GOOD, three=BAD)
    run = outside.runpytest_subprocess("-W", "error", "-n", "2")
    run.assert_outcomes(passed=2, failed=1)
