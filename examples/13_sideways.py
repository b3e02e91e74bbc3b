"""Sideways: a wide step and a narrow one in turn, designed for more and more travel, certified, walked, followed.

Two equal steps go nowhere. Let step A land with the ankles farther apart than step B, and two steps take the robot as
much to the side. Each step begins with the other one's landing; the map of the energy over both is the composition of
two affine maps, so its slope is the product m_A m_B, and one of the two may be unstable alone.

You should see:

    travel in two steps    speed          J                cost for each metre
    0.02 m                 0.013 m/s      239.44 N^2 m s   8190 N^2 m s
    0.06 m                 0.038 m/s      441.12 N^2 m s   4839 N^2 m s
    0.10 m                 0.063 m/s      853.30 N^2 m s   5302 N^2 m s
    certified              True
    multipliers            A 0.8092, B 0.7722, of both 0.6249
    fixed point            zeta_f* 325.05 after B, the map returns 325.05
    to the right           6 steps, completed, 0.30 m
    to the left            6 steps, completed, 0.30 m

With ``--out FOLDER`` the series becomes a figure, cost over speed. Are shorter steps faster,
and what do they cost? Ask for `fb.GaitSpecification(step_duration=(0.4, 0.6))`.
"""

import argparse
from pathlib import Path

import frontal_biped as fb
from frontal_biped.analysis import analyze_sideways
from frontal_biped.design import cost_of_travel
from frontal_biped.files.atomic import write_text
from frontal_biped.model.stance_map import Stance
from frontal_biped.zero_dynamics.two_steps import TwoStepMap


def main(out: Path | None = None, steps: int = 6) -> None:
    """Design the series, certify its last gait, walk it to either side."""
    robot = fb.load_robot("frontal_biped")
    points = cost_of_travel(robot, fb.GaitSpecification(), (0.02, 0.06, 0.1))
    print("travel in two steps    speed          J                cost for each metre")
    for point in points:
        gait = point.gait
        assert gait is not None, point.message
        print(
            f"{gait.travel:.2f} m                 {gait.speed:.3f} m/s      {gait.cost:.2f} N^2 m s  "
            f" {gait.cost_of_travel:.0f} N^2 m s"
        )
    analysis = analyze_sideways(robot, gait, certify=False)
    both = TwoStepMap(robot, gait.two_steps(robot))
    print(f"certified              {analysis.certified}")
    print(f"multipliers            A {both.rho_a.m:.4f}, B {both.rho_b.m:.4f}, of both {both.multiplier:.4f}")
    zeta = both.rho.fixed_point
    print(f"fixed point            zeta_f* {zeta:.2f} after B, the map returns {both.rho(zeta):.2f}")
    for side, stance in (("right", Stance.LEFT), ("left", Stance.RIGHT)):
        run = fb.simulate(robot, gait, steps=steps, stance=stance)  # 1 kHz, from sensor readings
        # the foot that stands alternates: a step of the same foot, two steps later, is one travel on
        way = abs(run.stance_y[-1] - run.stance_y[0]) - gait.a.step_width + gait.travel
        print(f"to the {side:5}           {run.steps_completed} steps, {run.outcome}, {way:.2f} m")
    if out is not None:
        from frontal_biped.figures import figure_svg
        from frontal_biped.figures.design import travel_figure

        write_text(out / "travel.svg", figure_svg(travel_figure({"steps up to 0.8 s": points})))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="folder of the figure")
    main(parser.parse_args().out)
