"""Smoke test of an installed wheel, run from a folder that has nothing to do with the project."""

import subprocess
import sys
from pathlib import Path

from robot_laws import LAWS

import frontal_biped as fb
from frontal_biped.model import models_dir

assert "site-packages" in str(models_dir()), f"robots come from {models_dir()}, not from the wheel"
names = fb.robot_names()
assert "frontal_biped" in names, names
for name in names:
    robot = fb.load_robot(name)
    for law in LAWS:
        law(robot)
    print(f"{name}: {robot.mass:.2f} kg, {len(LAWS)} laws hold")

result = fb.design_gait(fb.load_robot())
assert result.success, result.message
fb.save_gait(result.gait, "gait.json")

program = Path(sys.executable).with_name("frontal-biped")
for arguments in (
    ["--version"],
    ["robots", "--json"],
    ["analyze", "gait.json"],
    ["simulate", "gait.json", "--steps", "2", "-o", "run.npz"],
    ["view", "run.npz", "--html", "page.html"],
    ["view", "run.npz", "gait.json", "--ghost", "--html", "two.html"],
    ["export", "run.npz", "-o", "run.csv", "--rate", "200"],
    ["plot", "run.npz", "-o", "figures"],
    ["design", "--spec", "robust", "-o", "robust.json"],
    ["design", "--robot", "talos_full", "-o", "talos_full.json"],
    ["view", "talos_full.json", "--html", "talos_full.html"],
    ["robots", "--describe", str(fb.load_robot("g1").description.urdf), "-o", "my_g1.toml"],
    ["design", "--robot", "my_g1.toml"],
):
    subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)
    print("frontal-biped", *arguments)
assert Path("page.html").stat().st_size > 100_000
assert len(list(Path("figures").glob("*.svg"))) >= 7
print("the installed wheel works")
