"""The walk in space in words and from above."""

import re

import numpy as np
import pytest

from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.steered import Order, Picture
from frontal_biped.studio.steered_text import SIDE, Way, order_text, walk_text

SPOT = Order()


def picture(steps=0, order=SPOT, answered=(0, 0), refused="", x=0.0, yaw=0.0):
    stance = Stance.LEFT if steps % 2 == 0 else Stance.RIGHT
    foot = np.array([x, 0.1 * stance.sign, yaw])
    return Picture(
        0.7 * steps, np.zeros(7), np.array([x, 0.0, 0.8]), yaw, stance, steps, foot, order, answered, refused
    )


@pytest.mark.parametrize(
    ("order", "text"),
    [
        (Order(), "on the spot"),
        (Order(0.2), "forwards at 0.2 m/s"),
        (Order(-0.1, 0.05), "backwards at 0.1 m/s, to the left at 5 cm/s"),
        (Order(turn=-0.15), "turning right by 9 degrees a second"),
    ],
)
def test_orders_in_words(order, text):
    assert order_text(order) == text


def test_an_order_waits_then_is_answered():
    way, order = Way(), Order(0.1)
    way.add(picture())
    assert "from the next step on" in walk_text("", picture(), order, way)
    waiting = picture(4, order, (4, -1))
    assert "from the next step on" in walk_text("", waiting, order, way)
    assert "the order of step 5 is walked since step 6" in walk_text("", picture(5, order, (4, 5)), order, way)
    assert "not &lt;so&gt;" in walk_text("", picture(refused="not <so>"), order, way)
    assert "the walk has ended" in walk_text("fell", picture(), order, way)


def test_every_footstep_is_on_the_map_however_far_the_way():
    way = Way()
    for steps in range(30):
        assert way.add(picture(steps, x=0.5 * steps))
        assert not way.add(picture(steps, x=0.5 * steps + 0.1))
    page = walk_text("", picture(29, x=14.5, yaw=0.5), Order(), way)
    places = [[float(n) for n in pair] for pair in re.findall(r"<rect.*?translate\((\S+) (\S+)\)", page)]
    assert len(places) == 30
    assert all(0.0 < h < SIDE and 0.0 < v < SIDE for h, v in places)
    assert [v for _, v in places] == sorted((v for _, v in places), reverse=True)  # forwards is up
