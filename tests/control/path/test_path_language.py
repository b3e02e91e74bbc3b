"""The words of a path: what they mean, whatever they are, and what is said of those that mean nothing."""

import numpy as np
import pytest

from frontal_biped.control.path.language import EXAMPLE, Leg, PathError, Verb, parse_path
from frontal_biped.control.path.pose import Pose

ROUNDING = 1e-9
"""Of sums of a few hundred numbers of at most ten digits [m, rad]."""

AHEAD = {"forward": (1, 0), "back": (-1, 0), "left": (0, 1), "right": (0, -1)}


def test_the_example():
    stand, forward, left, turn, stop = parse_path(EXAMPLE)
    assert stand == Leg(Verb.STAND, Pose(), duration=1.0)
    assert forward == Leg(Verb.FORWARD, Pose(2.0, 0.0, 0.0))
    assert left.target == Pose(2.0, 1.0, 0.0)
    assert turn.target == pytest.approx((2.0, 1.0, np.pi / 2.0))
    assert (stop.verb, stop.target) == (Verb.STOP, turn.target)


@pytest.mark.parametrize("seed", range(20))
def test_any_path_is_a_chain_of_turns_and_ways(seed):
    """Against rotation matrices, whatever the case, blanks and units."""
    rng = np.random.default_rng(seed)
    words, at, R = [], np.zeros(2), np.eye(2)
    wanted = []
    for _ in range(30):
        verb = rng.choice(["stand", "turn", *AHEAD])
        size = round(float(rng.uniform(0.0, 3.0)), 3)
        unit = rng.choice(["", " m", "m"]) if verb in AHEAD else ""
        if verb == "turn":
            size = round(float(rng.uniform(-400.0, 400.0)), 2)
            turn = np.radians(size)
            R = R @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        elif verb in AHEAD:
            at = at + R @ AHEAD[verb] * size
        wanted.append((at, R))
        word = verb.upper() if rng.uniform() < 0.3 else verb
        words.append(f"{' ' * rng.integers(3)}{word} {size}{unit}")
    legs = parse_path(" ; ".join(words))
    assert legs[-1].standing
    for leg, (place, axes) in zip(legs, wanted, strict=False):
        assert np.abs(np.array(leg.target[:2]) - place).max() < ROUNDING
        x = np.array([np.cos(leg.target.yaw), np.sin(leg.target.yaw)])
        assert np.abs(x - axes[:, 0]).max() < ROUNDING


def test_rates():
    forward, turn, _ = parse_path("forward 2 m at 0.3 m/s; turn -90 degrees at 10")
    assert (forward.rate, turn.rate) == (0.3, pytest.approx(np.radians(10.0)))


def test_a_path_ends_in_a_stand():
    assert [leg.verb for leg in parse_path("forward 1")] == [Verb.FORWARD, Verb.STOP]
    assert [leg.verb for leg in parse_path(";forward 1;; stand 2;")] == [Verb.FORWARD, Verb.STAND]


def test_a_path_may_start_anywhere():
    (leg, _) = parse_path("forward 1", start=Pose(1.0, 2.0, np.pi / 2.0))
    assert leg.target == pytest.approx((1.0, 3.0, np.pi / 2.0))


@pytest.mark.parametrize(("text", "says"), [
    ("", "says nothing; write for example"),
    (" ; ;", "says nothing"),
    ("stop; fly 3", r"command 2 \('fly 3'\): no command 'fly'; known: stand, forward"),
    ("forward", "a number is missing after 'forward'; write for example 'forward 1 m'"),
    ("forward x", "'x' is no number"),
    ("forward nan", "nan is too much"),
    ("forward 1e9", "1e9 is too much; at most 1000 m"),
    ("stand inf", "inf is too much"),
    ("forward 2 ft", "'ft' is not the unit; it is m, and may be left out"),
    ("turn 90 m", "'m' is not the unit; it is degrees"),
    ("forward -2", "-2 is below 0; write 'back'"),
    ("stand -1", "-1 is below 0; write a number of at least 0"),
    ("turn 90 at 0", "a rate of 0 never arrives"),
    ("turn 90 at -5", "-5 is below 0"),
    ("forward 1 at", "a number is missing after 'at'"),
    ("forward 1 at 5", "5 is too much; at most 3 m/s"),
    ("stop now", "'now' is too much after 'stop'; separate commands by ';'"),
    ("forward 2 m left 1 m", "'left 1 m' is too much after 'forward'"),
])  # fmt: skip
def test_what_makes_no_path_is_refused_in_one_line(text, says):
    with pytest.raises(PathError, match=says) as refused:
        parse_path(text)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("seed", range(50))
def test_any_text_is_a_path_or_refused(seed):
    rng = np.random.default_rng(seed)
    bits = [
        *["stand", "forward", "turn", "stop", "left", "at", "m", "degrees", ";", ";", ";"],
        "1",
        "-2",
        "0.5",
        "\n",
        "nan",
        "1e99",
        "\0",
        "*",
    ]
    for _ in range(100):
        text = " ".join(rng.choice(bits, size=rng.integers(0, 12)))
        try:
            legs = parse_path(text)
        except PathError as refused:
            assert "\n" not in str(refused)
        else:
            assert legs[-1].standing
            assert all(np.isfinite(leg.target).all() for leg in legs)
