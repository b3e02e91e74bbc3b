"""The table of a walk in space: every joint under its URDF name."""

import csv
import io

import numpy as np
import pytest

from frontal_biped.simulation.csv_table import write_csv
from frontal_biped.simulation.space.table import spatial_table


def columns(header, rows):
    stream = io.StringIO()
    write_csv(stream, header, rows)
    table = list(csv.reader(io.StringIO(stream.getvalue())))
    return {name: [row[i] for row in table[1:]] for i, name in enumerate(table[0])}


def test_every_joint_is_there_under_its_name(talos, bend):
    table = columns(*spatial_table(talos, bend))
    for i, name in enumerate(talos.joint_names):
        for kind, values in (
            ("position [rad]", bend.q[:, 7 + i]),
            ("velocity [rad/s]", bend.v[:, 6 + i]),
            ("torque [N m]", bend.tau[:, i]),
        ):
            np.testing.assert_array_equal(np.array(table[f"{name} {kind}"], dtype=float), values)
    for name in talos.locked:
        assert len(set(table[f"{name} position, held [rad]"])) == 1
    np.testing.assert_array_equal(np.array(table["left sole force z [N]"], dtype=float), bend.wrench[:, 0, 2])
    assert set(table["right sole contact [0/1]"]) == {"0", "1"}
    assert table["left sole centre of pressure x [m]"][-1] != "" == table["right sole centre of pressure x [m]"][-1]


def test_coordinates_and_rate(talos, bend):
    header, rows = spatial_table(talos, bend, "stance", rate=100.0)
    assert "q1 stance_ankle [rad]" in header
    assert not any("sole" in name for name in header)
    times = np.array([float(row[0]) for row in rows])
    np.testing.assert_allclose(np.diff(times), 0.01)
    both, _ = spatial_table(talos, bend, "both")
    assert len(both) == len(set(both))
    with pytest.raises(ValueError, match="urdf, stance, both"):
        spatial_table(talos, bend, "polar")
