"""What robustness costs and what higher degrees buy: two figures, made by designing some thirty gaits.

    python examples/11_design_studies.py --out studies

You should see the cost rise from 210.2 N^2 m s as more energy is kept in hand before tipping, to 300.4 at a margin of
2, and fall by 4 % from degree 4 of the joints and 1 of the FRI (215.7) to degrees 8 and 3 (207.7).
"""

import argparse
from pathlib import Path

import frontal_biped as fb
from frontal_biped.design import StudyPoint, degree_study, pareto_front
from frontal_biped.figures import figure_svg
from frontal_biped.figures.design import degree_figure, pareto_figure
from frontal_biped.files.atomic import write_text


def show(point: StudyPoint) -> None:
    """One line a design."""
    print(f"{point.value!s:>6}  {point.result.message}", flush=True)


def main(out: Path, margins: int = 9, degrees: int = 8, fri_degrees: int = 3) -> None:
    """Design the series, print them, and write both figures."""
    robot, specification = fb.load_robot("frontal_biped"), fb.GaitSpecification()
    values = [0.25 * (i + 1) for i in range(margins)]
    front = pareto_front(robot, specification, "min_energy_margin", values, show)
    label = "energy margin, over the orbit's energy [-]"
    figure = pareto_figure(front, "energy_margin", label, "What an energy margin costs")
    write_text(out / "pareto.svg", figure_svg(figure))
    series = degree_study(robot, specification, range(4, degrees + 1), range(1, fri_degrees + 1), show)
    write_text(out / "degrees.svg", figure_svg(degree_figure(series)))
    print(f"written to {out}: pareto.svg, degrees.svg")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("studies"), help="folder; default: studies")
    main(parser.parse_args().out)
