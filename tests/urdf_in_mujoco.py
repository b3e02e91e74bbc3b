"""MuJoCo's own reading of a URDF, for tests that set its `qpos`."""

import xml.etree.ElementTree as ElementTree

import pytest


def mujoco_model(urdf_text):
    """MuJoCo's own reading of a URDF without its shapes, the root link free."""
    mujoco = pytest.importorskip("mujoco")
    root = ElementTree.fromstring(urdf_text)
    for link in root.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    options = {"fusestatic": "false", "balanceinertia": "true", "boundmass": "1e-6", "boundinertia": "1e-9"}
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", options)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.worldbody.first_body().add_freejoint()
    return spec.compile()
