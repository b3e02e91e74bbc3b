"""Processor time from URDF to certified gait, each humanoid, as rows of the README's table.

    python tests/benchmarks/benchmark_humanoids.py

No time is asserted; loading, designing and analysing are timed together, import and progress excluded.
"""

import time

import frontal_biped as fb

HUMANOIDS = ("talos_full", "romeo", "g1", "icub", "alexander", "human", "simple_humanoid_classical")


def main() -> None:
    fb.design_gait(fb.load_robot())  # imports and first calls are not the robot's
    for name in HUMANOIDS:
        began = time.process_time()
        robot = fb.load_robot(name)
        result = fb.design_gait(robot)
        if result.gait is None:
            print(f"{name}: {result.message}")
            continue
        analysis = fb.analyze(robot, result.gait)
        seconds = time.process_time() - began
        verdict = f"{seconds:.1f}" if analysis.certified else "not certified"
        print(
            f"| `{name}` | {robot.mass:.1f} | {robot.hip_width:.3f} | {100.0 * robot.asymmetry.mass_matrix:.2g}"
            f" | {analysis.cost:.1f} | {result.gait.orbit.step_duration:.2f} | {analysis.multiplier:.2f} | {verdict} |"
        )


if __name__ == "__main__":
    main()
