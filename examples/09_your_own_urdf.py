"""Your own URDF: let the package propose a description, load it, design a gait.

Any URDF with two legs whose hips and ankles roll will do. Here it is the Table I robot with a torso twice as heavy,
written to a folder as if it had come from elsewhere. `propose_description` finds the legs by axis, side and order
of the joints and the soles on the feet's shapes, and lists what it could not decide; on the command line,
`frontal-biped robots --describe my_biped.urdf -o my_biped.toml`.

You should see:

    left for you to decide: 0
    my_biped: 96.7 kg, hips 0.20 m apart
    sole from the ankle: -50, +50 mm; torque limits 150, 150 N m
    J = 478.3 N^2 m s, multiplier 0.789, certified, and walks 20 steps: True

Try to give one leg another mass: the load is refused, naming the hypothesis (HR3) and the remedy.
"""

import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import frontal_biped as fb
from frontal_biped.files.atomic import write_text
from frontal_biped.model import models_dir
from frontal_biped.model.urdf.proposal import propose_description


def heavier_robot(path: Path) -> None:
    """Write the URDF of the Table I robot with twice the mass and inertia of its heaviest link."""
    tree = ET.parse(models_dir() / "frontal_biped.urdf")
    inertials = tree.getroot().findall("link/inertial")

    def mass(inertial: ET.Element) -> float:
        element = inertial.find("mass")
        assert element is not None
        return float(element.attrib["value"])

    torso = max(inertials, key=mass)
    for element in (torso.find("mass"), torso.find("inertia")):
        assert element is not None
        element.attrib.update({key: str(2.0 * float(value)) for key, value in element.attrib.items()})
    tree.write(path)


def main(folder: Path) -> None:
    """URDF, description, robot, gait."""
    urdf, description = folder / "my_biped.urdf", folder / "my_biped.toml"
    heavier_robot(urdf)
    proposal = propose_description(urdf)
    write_text(description, proposal.text)
    print(f"left for you to decide: {len(proposal.undecided)}")
    robot = fb.load_robot(description)
    print(f"{robot.name}: {robot.mass:.1f} kg, hips {robot.hip_width:.2f} m apart")
    sole = ", ".join(f"{1e3 * end:+.0f}" for end in robot.sole)
    print(f"sole from the ankle: {sole} mm; torque limits {robot.max_torque[0]:.0f}, {robot.max_torque[1]:.0f} N m")
    result = fb.design_gait(robot)
    assert result.gait is not None, result.message
    orbit = result.gait.orbit
    figures = f"J = {orbit.cost:.1f} N^2 m s, multiplier {orbit.multiplier:.3f}"
    print(f"{figures}, certified, and walks 20 steps: {result.success}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        main(Path(name))
