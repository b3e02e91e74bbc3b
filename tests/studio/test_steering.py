"""Keys to orders: one step of one quantity a key, within bounds, and back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.simulation.space.steered import Order
from frontal_biped.studio.steering import KEYS, MOST, STEP, pressed

STOP = next(key for key in KEYS if key.change is None)
TURNS = [key for key in KEYS if key is not STOP]


def after(keys):
    order = Order()
    for key in keys:
        order = pressed(order, key)
    return order


@given(st.lists(st.sampled_from(KEYS), max_size=40))
def test_orders_stay_within_bounds_on_a_grid_and_the_space_bar_ends_them(keys):
    order = after(keys)
    for value, step, most in zip(order, STEP, MOST, strict=True):
        assert abs(value) <= most
        assert value == pytest.approx(step * round(value / step), abs=1e-12)
    assert pressed(order, STOP) == Order()


@pytest.mark.parametrize("key", TURNS, ids=lambda key: f"{key.modifier}+{key.name}")
def test_every_key_changes_one_quantity_and_another_key_takes_it_back(key):
    once = pressed(Order(), key)
    assert sum(value != 0.0 for value in once) == 1
    assert Order() in [pressed(once, other) for other in TURNS if other is not key]


def test_the_arrows_point_where_the_robot_goes():
    """Left is the robot's left, positive in the world; up is forwards."""
    of = {(key.modifier, key.name): pressed(Order(), key) for key in KEYS}
    assert of["", "arrowup"].speed > 0.0 > of["", "arrowdown"].speed
    assert of["", "arrowleft"].turn > 0.0 > of["", "arrowright"].turn
    assert of["shift", "arrowleft"].lateral > 0.0 > of["shift", "arrowright"].lateral
