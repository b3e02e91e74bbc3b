"""URDFs and descriptions of bipeds with given parameters."""

from collections.abc import Mapping
from pathlib import Path


def write_robot(folder: Path, name: str, parameters: Mapping[str, float]) -> Path:
    """Write URDF and description of a biped with the given parameters; returns the description.

    Lateral offsets of a leg's and a foot's centre of mass (leg_lat, fx) are counted towards the other leg.
    The foot's centre of mass lies fy below the ankle, the torso's ty above the middle of the hip line. Joints turn by
    hip_in, ankle_in at most towards the other leg and by hip_out, ankle_out away from it [rad], 1 where not given, and
    give ``effort`` [N m], 150 where not given.
    """
    p = parameters
    effort = p.get("effort", 150)

    def link(link_name: str, y: float, z: float, mass: float, inertia: float) -> str:
        moments = f'ixx="{inertia!r}" iyy="{inertia!r}" izz="{inertia!r}" ixy="0" ixz="0" iyz="0"'
        return (
            f'<link name="{link_name}"><inertial><origin xyz="0 {y!r} {z!r}"/>'
            f'<mass value="{mass!r}"/><inertia {moments}/></inertial></link>\n'
        )

    def joint(side: str, name: str, parent: str, child: str, y: float, z: float) -> str:
        inwards, outwards = p.get(f"{name}_in", 1.0), p.get(f"{name}_out", 1.0)
        # turned about X, forward, what hangs below the joint moves to the left
        lower, upper = (-inwards, outwards) if side == "left" else (-outwards, inwards)
        return (
            f'<joint name="{side}_{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 {y!r} {z!r}"/><axis xyz="1 0 0"/>'
            f'<limit lower="{lower!r}" upper="{upper!r}" effort="{effort!r}" velocity="10"/></joint>\n'
        )

    # Y points left; tx is measured from the stance hip, and HR3 puts the torso in the middle
    urdf = f'<robot name="{name}">\n' + link("pelvis", 0.5 * p["W"] - p["tx"], p["ty"], p["mt"], p["Jt"])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        urdf += link(f"{side}_leg", -sign * p["leg_lat"], -p["leg_com"], p["ml"], p["Jl"])
        urdf += link(f"{side}_foot", -sign * p["fx"], -p["fy"], p["mf"], p["Jf"])
        urdf += joint(side, "hip", "pelvis", f"{side}_leg", sign * 0.5 * p["W"], 0.0)
        urdf += joint(side, "ankle", f"{side}_leg", f"{side}_foot", 0.0, -p["L"])
    (folder / f"{name}.urdf").write_text(urdf + "</robot>\n", encoding="utf-8")
    joints = "".join(f'{key} = "{key}"\n' for key in ("left_ankle", "left_hip", "right_hip", "right_ankle"))
    sole = f"inner = {p['e_in']}\nouter = {p['e_out']}\nankle_height = {p['ha']}\n"
    description = folder / f"{name}.toml"
    description.write_text(
        f'name = "{name}"\nurdf = "{name}.urdf"\n\n[joints]\n{joints}\n[sole]\n{sole}', encoding="utf-8"
    )
    return description
