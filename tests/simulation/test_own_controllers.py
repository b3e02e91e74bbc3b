"""Controllers of the user's own in a walk: a function of (t, q, v), in the plane and in space, and refusals."""

from types import SimpleNamespace

import numpy as np
import pytest
from whole_robots import whole

from frontal_biped.control.walker.walker import Walker
from frontal_biped.exceptions import ControllerError
from frontal_biped.scenarios import load_scenario, run_scenario
from frontal_biped.simulation.walking import simulate


def replay(motion, names, stiffness, damping):
    """The orbit's torques, and a spring and a damper to its joints: what a driver of a real robot would do first."""

    def law(t, q, v):
        k = min(round(t / (motion.t[1] - motion.t[0])), len(motion.t) - 1)
        return {
            name: motion.torques[name][k]
            + stiffness * (motion.positions[name][k] - q[name])
            + damping * (motion.velocities[name][k] - v[name])
            for name in names
        }

    return law


def test_a_gait_replayed_by_joint_name_walks_a_step(biped, gait):
    """The exported orbit is all the law knows: names, signs, torques and times must be right for the foot to land."""
    motion = gait.trajectory(biped, 1000.0, steps=2)
    law = replay(motion, biped.stance_map.joint_names, 2000.0, 60.0)
    run = simulate(biped, gait, steps=1, controller=law)
    assert not run.fell and run.steps_completed == 1
    assert run.t[-1] == pytest.approx(gait.orbit.step_duration, rel=0.02)
    wanted = np.interp(run.t, motion.t, motion.positions[biped.stance_map.joint_names[1]])
    first = run.step == 0.0
    np.testing.assert_allclose(run.positions["left_hip"][first], wanted[first], atol=0.02)
    assert run.settings["controller"]["kind"] == "LawWalker"


def test_the_other_two_contracts_are_taken_too(biped, gait):
    run = simulate(biped, gait, steps=1, period=1e-3, controller=Walker(biped, gait))
    assert run.steps_completed == 1 and run.settings["controller"]["kind"] == "Walker"


def test_what_is_no_controller_and_what_returns_no_torques_is_refused_in_one_line(biped, gait):
    for own, words in (
        (3.0, "controller = float: no controller; give a function of"),
        (lambda t, q, v: None, "at t = 0.0000 s returned NoneType; return a dict of torques"),
        (lambda t, q, v: dict.fromkeys(q, float("nan")), "return a finite number"),
    ):
        with pytest.raises(ControllerError, match=words) as error:
            simulate(biped, gait, steps=1, controller=own)
        assert "\n" not in str(error.value)


def test_a_scenario_names_a_law_as_it_names_a_factory(tmp_path):
    """And its wrong answer is a refusal with the time at which it came, not a traceback."""
    (tmp_path / "my_laws.py").write_text(
        "def late(t, q, v):\n    return dict.fromkeys(q, 0.0) if t < 0.01 else [1.0]\n"
        "def make(robot, gait, period):\n    return lambda t, q, v: q.keys()\n",
        encoding="utf-8",
    )
    for name, words in (("late", r"'late' at t = 0.0100 s returned an array of shape \(1,\)"), ("make", "dict_keys")):
        path = tmp_path / f"{name}.scenario.toml"
        path.write_text(f'steps = 1\ngait = "robust"\ncontroller = "my_laws:{name}"\n', encoding="utf-8")
        with pytest.raises(ControllerError, match=words):
            run_scenario(load_scenario(path))


def test_in_space_a_law_moves_every_joint():
    """A spring and a damper to the planar orbit, some tenths of a step: the robot stands on the foot it should."""
    pytest.importorskip("mujoco")
    from frontal_biped.simulation.space.settings import SpatialSettings
    from frontal_biped.simulation.space.walk_spatial import walk_spatial

    robot = whole("talos_full")
    seen = []
    motion = robot.gait.trajectory(robot.biped, 100.0, steps=1)
    law = replay(motion, robot.free.joint_names, 2000.0, 40.0)

    def watched(t, q, v):
        seen.append((t, tuple(q)))
        if t > 0.15:
            raise RuntimeError("seen enough")
        return law(t, q, v)

    with pytest.raises(ControllerError, match=r"'watched' at t = 0\.1510 s fails, RuntimeError: seen enough"):
        walk_spatial(robot.biped, robot.gait, controller=watched, settings=SpatialSettings(steps=1))
    assert {names for _, names in seen} == {robot.free.joint_names}
    assert len(seen) == 152


class Answers:
    """A controller of either contract that answers what it is told to."""

    def __init__(self, answer):
        self.tick = self.command = lambda *asked: answer
        self.reset = self.begin = lambda *start: None


@pytest.mark.parametrize("method", ["tick", "command"])
@pytest.mark.parametrize(
    ("torques", "words"),
    [
        (None, "returned NoneType without {name}; return an object whose {name} are 4 finite numbers"),
        ([0.0] * 3, "with {name} = .0.0, 0.0, 0.0.; return"),
        ([0.0, 0.0, 0.0, float("nan")], "nan.; return"),
        ("much", "with {name} = 'much'; return"),
    ],
)
def test_objects_that_answer_no_torques_are_refused_too(method, torques, words, biped, gait):
    name = "joint_torques" if method == "tick" else "u"
    own = Answers(None if torques is None else SimpleNamespace(**{name: torques}))
    for other in {"tick": ("command", "begin"), "command": ("tick", "reset")}[method]:
        delattr(own, other)
    with pytest.raises(
        ControllerError, match=f"the controller's {method} at t = 0.*{words.format(name=name)}"
    ) as error:
        simulate(biped, gait, steps=1, period=1e-3, controller=own)
    assert "\n" not in str(error.value)
