"""A gait library: design on a grid, blend between its points, and change from one gait to another within a step.

A library is a folder with a gait file for every point of a grid; kill it at any moment and run it again. Between the
points `blend` returns a gait that is invariant and periodic to rounding. `design_transition` designs the single
step that leads from one gait to another without leaving the zero dynamics. On the command line,
`frontal-biped library sweep.toml -o gaits`.

You should see:

    designed 3 gaits of 3; a second run finds 3 and designs none
      roll within 0.10 rad: J = 389.0
      roll within 0.12 rad: J = 368.0
      roll within 0.14 rad: J = 350.8
    between them, 0.11 rad: J = 377.9, residuals below 1e-9: True
    one step from the first gait to the second: J = 576.2, constraints kept: True, arrives at the right speed: True

Try to pass `worker_processes(2)` as the third argument of `build_library`: the same files, byte for byte.
"""

import tempfile
from pathlib import Path

import frontal_biped as fb
from frontal_biped.design import design_transition
from frontal_biped.files.atomic import write_text
from frontal_biped.library import GaitLibrary, build_library, read_sweep

SWEEP = """
robot = "frontal_biped"
[sweep]
max_pelvis_roll = [0.10, 0.12, 0.14]
"""


def main(folder: Path) -> None:
    """Build, blend, change over."""
    robot = fb.load_robot("frontal_biped")
    write_text(folder / "sweep.toml", SWEEP)
    sweep = read_sweep(folder / "sweep.toml")
    first = build_library(sweep, folder / "gaits")
    again = build_library(sweep, folder / "gaits")
    print(f"designed {first.gaits} gaits of {first.points}; a second run finds {again.found} and designs none")

    library = GaitLibrary(folder / "gaits")
    for number in range(len(library)):
        gait = library.gait(number)
        assert gait is not None
        print(f"  roll within {library.points[number].swept['max_pelvis_roll']:.2f} rad: J = {gait.orbit.cost:.1f}")
    blend = library.blend(robot, {"max_pelvis_roll": 0.11})
    worst = max(blend.gait.residuals(robot).values())
    print(f"between them, 0.11 rad: J = {blend.gait.orbit.cost:.1f}, residuals below 1e-9: {worst < 1e-9}")

    before, after = library.gait(0), library.gait(1)
    assert before is not None and after is not None
    change = design_transition(robot, before, after)
    print(f"one step from the first gait to the second: J = {change.cost:.1f}, constraints kept:", end=" ")
    print(f"{change.report.satisfied}, arrives at the right speed: {abs(change.speed_error) < 1e-9}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        main(Path(name))
