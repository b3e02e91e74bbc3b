"""A path as steps: of a walker whose feet land where they are to land, and of one whose feet do not."""

import numpy as np
import pytest

from frontal_biped.control.path.follower import FollowerSettings, PathFollower
from frontal_biped.control.path.language import parse_path
from frontal_biped.control.path.pose import Pose
from frontal_biped.model.stance_map import Stance

DURATION, WIDTH = 0.7, 0.3  # [s], [m]

SETTINGS = FollowerSettings()

ROUNDING = 1e-9


def foot_of(stand, stance):
    return stand.moved(0.0, 0.5 * stance.sign * WIDTH, 0.0)


class Feet:
    """Feet that are put where the plan says, off by noise of a size."""

    def __init__(self, path, noise=0.0, seed=0, settings=SETTINGS):
        self.follower = PathFollower(parse_path(path), DURATION, WIDTH, settings)
        self.rng, self.noise = np.random.default_rng(seed), noise
        self.plans, self.stood = [], []

    def walk(self, most=500):
        """Stances and stands at the landings, until the path is over."""
        follower, stand, t = self.follower, Pose(), 0.0
        feet = {side: foot_of(stand, side) for side in Stance}
        while not follower.finished:
            stood = 0.0
            while not follower.stand(stood) and not follower.finished:
                stood += 0.1
            self.stood.append(stood)
            if follower.finished:
                return feet
            stance = follower.first_stance
            while True:
                t += 1
                assert t < most, "it does not arrive"
                plan = follower.begin(stance, feet[stance])
                self.plans.append((stance, plan))
                at = feet[stance].moved(0.0, -0.5 * stance.sign * WIDTH, 0.0)
                x, y, _ = foot_of(at.moved(plan.length, plan.aside, plan.turn), stance.other)
                off_x, off_y = self.noise * self.rng.normal(size=2)
                stance = stance.other
                feet[stance] = Pose(x + off_x, y + off_y, plan.next_yaw)
                if follower.arrives(stance, feet[stance]):
                    break
        return feet


PATHS = [
    "stand 1; forward 2 m; left 1 m; turn 90; forward 1 m; stop",
    "back 0.5; right 0.3; turn -200",
    "turn 45; forward 1 at 0.4; stand 2; forward 1; turn -45 at 5; left 0.2 at 0.03",
    "forward 0.05; stand 0.5; right 0.01",
]


@pytest.mark.parametrize("path", PATHS)
def test_exact_feet_end_at_the_end(path):
    feet = Feet(path)
    ended = feet.walk()
    target = parse_path(path)[-1].target
    for side in Stance:
        assert ended[side] == pytest.approx(foot_of(target, side), abs=SETTINGS.near)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("seed", range(5))
def test_feet_that_miss_end_there_too(path, seed):
    """Every error is taken up by the next step: what is left is that of the last two."""
    noise = 0.004
    ended = Feet(path, noise, seed).walk()
    target = parse_path(path)[-1].target
    middle = 0.5 * (np.array(ended[Stance.LEFT]) + ended[Stance.RIGHT])
    assert np.abs(middle - target).max() < SETTINGS.near + 4.0 * noise


@pytest.mark.parametrize("path", PATHS)
def test_steps_are_no_larger_than_they_may_be(path):
    feet = Feet(path, 0.004)
    feet.walk()
    legs = parse_path(path)
    most = {
        "length": max([SETTINGS.speed, *(leg.rate or 0.0 for leg in legs if leg.verb.value == "forward")]),
        "aside": SETTINGS.lateral,
        "turn": max([SETTINGS.turning, *(leg.rate or 0.0 for leg in legs if leg.verb.value == "turn")]),
    }
    for name, rate in most.items():
        assert max(abs(getattr(plan, name)) for _, plan in feet.plans) <= rate * DURATION + ROUNDING
    lengths = np.array([0.0, *(plan.length for _, plan in feet.plans)])
    assert np.abs(np.diff(lengths)).max() <= SETTINGS.speed_change * DURATION + ROUNDING


def test_what_is_expected_of_the_next_step_comes():
    feet = Feet(PATHS[0])
    feet.walk()
    for (_, plan), (_, following) in zip(feet.plans[:-1], feet.plans[1:], strict=True):
        assert plan.next_length == pytest.approx(following.length, abs=ROUNDING)
        assert plan.next_turn == pytest.approx(following.turn, abs=ROUNDING)


def test_stands_last_as_long_as_they_are_to():
    feet = Feet("stand 1; stand 2; forward 0.2; stand 3; forward 0.2; stop")
    feet.walk()
    assert feet.stood == pytest.approx([3.0, 3.0, SETTINGS.rest], abs=0.11)


@pytest.mark.parametrize(("path", "first"), [
    ("left 1", Stance.RIGHT), ("right 1", Stance.LEFT), ("turn 90", Stance.RIGHT), ("stand 1; turn -9", Stance.LEFT),
])  # fmt: skip
def test_the_first_foot_steps_to_its_own_side(path, first):
    feet = Feet(path)
    feet.walk()
    stance, plan = feet.plans[0]
    assert stance is first
    assert plan.widening(stance) > 0.0 or plan.turn * stance.sign < 0.0


def test_sideways_steps_are_wide_and_narrow_in_turn():
    feet = Feet("left 1")
    feet.walk()
    wide = [plan.widening(stance) for stance, plan in feet.plans[:10]]
    a = SETTINGS.lateral * DURATION
    assert wide == pytest.approx([a, -a] * 5)
