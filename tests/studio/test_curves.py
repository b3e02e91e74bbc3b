"""The gait in curves, in the studio's panel."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from frontal_biped.model.chain import JOINTS
from frontal_biped.simulation import orbit_trajectory
from frontal_biped.studio.curves import HEIGHT, WIDTH, gait_curves


def test_curves_are_the_first_step_of_the_orbit(biped, gait):
    """Every joint over time, both phases in the plane, all inside their frames, and the ends are the step's."""
    orbit = orbit_trajectory(biped, gait, 2, samples=41)
    drawn = gait_curves(orbit)
    assert all(name in drawn for name in JOINTS)
    angles, plane = (ElementTree.fromstring(svg) for svg in re.findall(r"<svg.*?</svg>", drawn))
    assert len(angles.findall("polyline")) == 4
    assert [line.get("stroke-dasharray") != "" for line in plane.findall("polyline")] == [False, True]
    for line in (*angles.findall("polyline"), *plane.findall("polyline")):
        x, y = np.array([pair.split(",") for pair in line.get("points").split()], dtype=float).T
        assert x.min() >= 0.0 and x.max() <= WIDTH
        assert y.min() >= 0.0 and y.max() <= HEIGHT
    said = [text.text for text in angles.findall("text")]
    assert said[:2] == ["0", f"{gait.orbit.step_duration:.3g}"]
    assert {"time [s]", "angle [degrees]"} <= set(said)
    low, high = (float(text.text.replace("−", "-")) for text in plane.findall("text")[2:4])
    step = orbit.first_steps(1).dq[:, 0]
    np.testing.assert_allclose([low, high], [step.min(), step.max()], rtol=5e-3)
