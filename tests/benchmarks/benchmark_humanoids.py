"""Processor time from URDF to certified gait, each humanoid, as rows of a table.

    python tests/benchmarks/benchmark_humanoids.py

No time is asserted; loading, designing and analysing are timed together, import and progress excluded. The humanoids
are described in models/, each with a gait beside it; the URDFs are those of example-robot-data 5 or 6. Steps of 0.3
to 0.8 s, 0.8 to 1.8 hip widths wide, 8 mm of clearance, 10 degrees of pelvis roll, and everything within the URDF's
limits. What it printed (the seconds are processor time of one core):

| robot | mass, kg | hip width, m | legs differ by, % of D | J, N^2 m s | T, s | multiplier | URDF to gait, s |
|---|---|---|---|---|---|---|---|
| `talos_full` | 93.3 | 0.170 | 0.0011 | 536.8 | 0.73 | 0.86 | 2.9 |
| `romeo` | 40.5 | 0.192 | 0 | 204.6 | 0.30 | 0.72 | 4.7 |
| `g1` | 33.3 | 0.233 | 0.0069 | 265.2 | 0.30 | 0.60 | 4.3 |
| `icub` | 28.3 | 0.136 | 0.17 | 79.6 | 0.30 | 0.69 | 3.1 |
| `alexander` | 49.1 | 0.119 | 0.0091 | 1994.1 | 0.30 | 0.38 | 3.3 |
| `human` | 74.7 | 0.164 | 0.12 | 840.8 | 0.70 | 0.83 | 5.5 |
| `simple_humanoid_classical` | 130.8 | 0.180 | 0.0066 | 373.5 | 0.54 | 0.90 | 1.4 |
"""

import time

import frontal_biped as fb
from frontal_biped.design import optimise_gait

HUMANOIDS = ("talos_full", "romeo", "g1", "icub", "alexander", "human", "simple_humanoid_classical")


def main() -> None:
    optimise_gait(fb.load_robot())  # imports and first calls are not the robot's
    for name in HUMANOIDS:
        began = time.process_time()
        robot = fb.load_robot(name)
        result = optimise_gait(robot)
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
