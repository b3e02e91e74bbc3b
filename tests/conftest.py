"""Robots, independently computed numbers and designed gaits that the tests share."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from frontal_biped.design import DesignResult, GaitSpecification, design_gait, load_specification
from frontal_biped.gait import Gait
from frontal_biped.model import FrontalBiped, load_robot

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
    return design_gait(biped, GaitSpecification())


@pytest.fixture(scope="session")
def level_design(biped: FrontalBiped) -> DesignResult:
    """The same with the pelvis level to five degrees."""
    return design_gait(biped, GaitSpecification(max_pelvis_roll=float(np.radians(5.0))))


@pytest.fixture(scope="session")
def reference_gait(reference_design: DesignResult) -> Gait:
    assert reference_design.gait is not None, reference_design.message
    return reference_design.gait


@pytest.fixture(scope="session")
def level_gait(level_design: DesignResult) -> Gait:
    assert level_design.gait is not None, level_design.message
    return level_design.gait


@pytest.fixture(scope="session")
def robust_gait(biped: FrontalBiped) -> Gait:
    """The gait of the shipped specification `robust`."""
    result = design_gait(biped, load_specification("robust"))
    assert result.gait is not None, result.message
    return result.gait


def write_robot(folder: Path, name: str, parameters: Mapping[str, float]) -> Path:
    """Write URDF and description of a biped with the given parameters; returns the description.

    Lateral offsets of a leg's and a foot's centre of mass (leg_lat, fx) are counted towards the other leg.
    The foot's centre of mass lies fy below the ankle, the torso's ty above the middle of the hip line.
    """
    p = parameters

    def link(link_name: str, y: float, z: float, mass: float, inertia: float) -> str:
        moments = f'ixx="{inertia!r}" iyy="{inertia!r}" izz="{inertia!r}" ixy="0" ixz="0" iyz="0"'
        return (
            f'<link name="{link_name}"><inertial><origin xyz="0 {y!r} {z!r}"/>'
            f'<mass value="{mass!r}"/><inertia {moments}/></inertial></link>\n'
        )

    def joint(joint_name: str, parent: str, child: str, y: float, z: float) -> str:
        return (
            f'<joint name="{joint_name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 {y!r} {z!r}"/><axis xyz="1 0 0"/>'
            '<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/></joint>\n'
        )

    # Y points left; tx is measured from the stance hip, and HR3 puts the torso in the middle
    urdf = f'<robot name="{name}">\n' + link("pelvis", 0.5 * p["W"] - p["tx"], p["ty"], p["mt"], p["Jt"])
    for side, outwards in (("left", 1.0), ("right", -1.0)):
        urdf += link(f"{side}_leg", -outwards * p["leg_lat"], -p["leg_com"], p["ml"], p["Jl"])
        urdf += link(f"{side}_foot", -outwards * p["fx"], -p["fy"], p["mf"], p["Jf"])
        urdf += joint(f"{side}_hip", "pelvis", f"{side}_leg", outwards * 0.5 * p["W"], 0.0)
        urdf += joint(f"{side}_ankle", f"{side}_leg", f"{side}_foot", 0.0, -p["L"])
    (folder / f"{name}.urdf").write_text(urdf + "</robot>\n", encoding="utf-8")
    joints = "".join(f'{key} = "{key}"\n' for key in ("left_ankle", "left_hip", "right_hip", "right_ankle"))
    sole = f"inner = {p['e_in']}\nouter = {p['e_out']}\nankle_height = {p['ha']}\n"
    description = folder / f"{name}.toml"
    description.write_text(
        f'name = "{name}"\nurdf = "{name}.urdf"\n\n[joints]\n{joints}\n[sole]\n{sole}', encoding="utf-8"
    )
    return description
