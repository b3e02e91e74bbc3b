"""No impact: a foot that arrives at rest, a double support that lasts, and a robot that stands, walks and stands.

With both feet flat one freedom is left, and ten unknowns for seven equations: along that family the motion can be
chosen as long as both soles hold. A step that begins and ends with the slope of the family lands without an impact, and
falls as it rose, so that every error of its speed would stay. The double support takes it away, in one step: whatever
the robot lands with, it lifts off with the speed that is planned. The price is J.

You should see:

    double support         0.101 of 0.440 s, J = 5914 N^2 m s
    impulse of a landing   below 1e-12 of the momentum
    slope without it       1.0000, with it 0
    arrivals made up for   0.30 to 1.43 of the orbit's speed
    ours                   first lift-off +0.0 %, 4 steps, completed, at rest 1 landing after the command
    mujoco                 first lift-off -0.0 %, 4 steps, completed, at rest 1 landing after the command

With ``--out FOLDER`` the load of a landing foot becomes a figure, beside that of a gait with impacts. Does the robot
forgive more? Try `walk_from_lift_off(robot, gait, speed_error=0.3)`.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import frontal_biped as fb
from frontal_biped.design.support_design import design_support_gait
from frontal_biped.files.atomic import write_text
from frontal_biped.gait.specification import default_specification
from frontal_biped.gait.support_certificate import certify_support_gait
from frontal_biped.gait.support_gait import SupportSpecification
from frontal_biped.simulation.support_walk import stand_walk_stand


def main(out: Path | None = None, steps: int = 3) -> None:
    """Design and certify the gait, walk it from a stand to a stand."""
    robot = fb.load_robot("frontal_biped")
    bounds = replace(default_specification(robot), min_phase_range=0.04)
    found = design_support_gait(robot, SupportSpecification(bounds))
    gait, certificate = found.gait, certify_support_gait(robot, found.gait)
    assert certificate.holds
    print(f"double support         {found.double_support:.3f} of {found.duration:.3f} s, J = {found.cost:.0f} N^2 m s")
    print(f"impulse of a landing   {'below' if certificate.impulse < 1e-12 else 'above'} 1e-12 of the momentum")
    print(f"slope without it       {certificate.slope:.4f}, with it 0")
    slowest, fastest = certificate.arrivals
    print(f"arrivals made up for   {slowest:.2f} to {fastest:.2f} of the orbit's speed")
    for engine in ("ours", "mujoco"):
        run = stand_walk_stand(robot, gait, steps=steps, engine=engine)
        first = 100.0 * (run.steps[0].speed / gait.speed - 1.0)
        print(
            f"{engine:22} first lift-off {first:+.1f} %, {len(run.steps)} steps, {run.outcome}, at rest"
            f" {run.landings_to_rest} landing after the command"
        )
    if out is not None:
        from frontal_biped.analysis.landing_load import load_with_impact, load_without_impact
        from frontal_biped.figures import figure_svg
        from frontal_biped.figures.landing_load import landing_load_figure

        plain = fb.design_gait(robot, quick=True).gait
        figure = landing_load_figure(load_without_impact(robot, gait), load_with_impact(robot, plain))
        write_text(out / "landing_load.svg", figure_svg(figure))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="folder of the figure")
    main(parser.parse_args().out)
