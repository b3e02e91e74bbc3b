"""The report: animation, key numbers, constraints and figures on one self-contained page."""

import html
import math
import re
from collections.abc import Sequence
from string import Template

from frontal_biped.demo.typeset import typeset
from frontal_biped.figures.style import DARK
from frontal_biped.figures.write import FIGURES
from frontal_biped.files.counted import counted
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.numerics.verdict import COLUMNS
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.viewer.page import animation_page, closed_page, web_text

_HERE = "frontal_biped.demo"  # whose folder ``web`` holds the page

NumberRow = tuple[str, float | int | str, str]
"""(name, value, unit)."""

ConstraintRow = tuple[str, str, float | str, float | str, float | str | None, str]
"""(code, name, value, bound, margin, unit); margins may be formatted. A negative margin, or one that is no number, is
a violation; None means there is none to give."""


def report_page(
    biped: FrontalBiped,
    trajectory: Trajectory,
    figures: Sequence[tuple[str, str]],
    numbers: Sequence[NumberRow] = (),
    constraints: Sequence[ConstraintRow] = (),
    robustness: Sequence[tuple[str, Sequence[tuple[str, str]]]] = (),
    statements: Sequence[tuple[str, str, str]] = (),
    notes: Sequence[str] = (),
    title: str | None = None,
    subtitle: str = "",
    animation: str | None = None,
) -> str:
    """One HTML page that needs no network: the animated robot beside its numbers, constraints and figures.

    Args:
        biped: the robot.
        trajectory: the run to animate.
        figures: (caption, or a name of `FIGURES` that stands for its caption; SVG element from `figure_svg`).
        numbers: key numbers.
        constraints: constraint table.
        robustness: (gait, rows of name and text) of robustness cards.
        statements: what was said of the gait, the verdict by measurement, and the one by proof.
        notes: paragraphs of plain text.
        title: of the page; None: the robot's name.
        subtitle: a line below it.
        animation: `animated` of the same run, where it has been made already.

    Returns:
        The page's text.
    """
    heading = title or f"{biped.name}: frontal-plane walking"
    outcome = f"{counted(trajectory.steps_completed, 'step')}, {trajectory.outcome}"
    body = Template(web_text("report.html", _HERE)).substitute(
        title=html.escape(heading),
        subtitle=html.escape(subtitle or outcome),
        animation=html.escape(animation or animated(biped, trajectory), quote=True),
        numbers=_numbers_table(numbers),
        constraints=_constraint_table(constraints),
        notes=_statement_table(statements) + _robustness_tables(robustness) + _notes(notes),
        figures="\n".join(
            f"<figure>\n{_both_schemes(svg)}\n"
            f"<figcaption>{html.escape(FIGURES.get(caption, caption))}</figcaption>\n</figure>"
            for caption, svg in figures
        ),
    )
    dark = " ".join(f"{_variable(light)}: {dark};" for light, dark in DARK.items())
    style = web_text("report.css", _HERE) + f"@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"
    return closed_page(heading, style, body, schemes="light dark")


def animated(biped: FrontalBiped, trajectory: Trajectory) -> str:
    """The page of the moving robot that a report holds."""
    return animation_page(biped, trajectory, title=biped.name, theme="auto")


def _variable(colour: str) -> str:
    return f"--figure-{colour.removeprefix('#')}"


def _both_schemes(svg: str) -> str:
    """A figure whose colours of `DARK` are variables of the page's style, lest it shine in the dark."""
    return _COLOUR.sub(lambda found: f"var({_variable(found[0])}, {found[0]})" if found[0] in DARK else found[0], svg)


_COLOUR = re.compile(r"(?<=: )#[0-9a-f]{6}\b")
"""A colour in a style."""


def _numbers_table(rows: Sequence[NumberRow]) -> str:
    if not rows:
        return ""
    body = "\n".join(
        f'<tr><th scope="row">{typeset(name)}</th><td>{_value(value)}</td><td class="unit">{typeset(unit)}</td></tr>'
        for name, value, unit in rows
    )
    return f'<section id="numbers">\n<h2>Key numbers</h2>\n<table>\n<tbody>\n{body}\n</tbody>\n</table>\n</section>'


def _constraint_table(rows: Sequence[ConstraintRow]) -> str:
    if not rows:
        return ""
    lines = []
    for code, name, value, bound, margin, unit in rows:
        kept = margin is None or _at_least_zero(margin)
        mark = "" if margin is None else f'<span class="mark">{"kept" if kept else "violated"}</span> '
        shown = "" if margin is None else _value(margin)
        lines.append(
            f'<tr class="{"kept" if kept else "violated"}"><th scope="row">{html.escape(code)}</th>'
            f'<td class="text">{typeset(name)}</td><td data-name="value">{_value(value)}</td>'
            f'<td data-name="bound">{_value(bound)}</td>'
            f'<td data-name="margin">{mark}{shown}</td><td class="unit">{typeset(unit)}</td></tr>'
        )
    head = "".join(f'<th scope="col">{word}</th>' for word in ("", "constraint", "value", "bound", "margin", "unit"))
    body = "\n".join(lines)
    return (
        f'<section id="constraints">\n<h2>Constraints</h2>\n<div class="scroll"><table>\n'
        f"<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table></div>\n</section>"
    )


def _statement_table(rows: Sequence[tuple[str, str, str]]) -> str:
    if not rows:
        return ""
    body = "\n".join(
        f'<tr><th scope="row">{typeset(name)}</th><td>{html.escape(measured)}</td><td>{html.escape(proved)}</td></tr>'
        for name, measured, proved in rows
    )
    head = "".join(f'<th scope="col">{word}</th>' for word in COLUMNS)
    return (
        f'<section id="statements">\n<h2>Proof</h2>\n<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody>\n</table></div>\n</section>\n"
    )


def _robustness_tables(cards: Sequence[tuple[str, Sequence[tuple[str, str]]]]) -> str:
    if not cards:
        return ""
    tables = []
    for gait, rows in cards:
        body = "\n".join(
            f'<tr><th scope="row">{html.escape(name.strip())}</th><td class="text">{typeset(text)}</td></tr>'
            for name, text in rows
        )
        tables.append(
            f'<h3>{html.escape(gait)}</h3>\n<div class="scroll"><table>\n<tbody>\n{body}\n</tbody>\n</table></div>'
        )
    joined = "\n".join(tables)
    return f'<section id="robustness">\n<h2>Robustness</h2>\n{joined}\n</section>\n'


def _notes(notes: Sequence[str]) -> str:
    if not notes:
        return ""
    paragraphs = "\n".join(f"<p>{typeset(note)}</p>" for note in notes)
    return f'<section id="notes">\n<h2>Notes</h2>\n{paragraphs}\n</section>'


def _at_least_zero(margin: float | str) -> bool:
    try:
        return float(margin) >= 0.0  # not a number is unknown, and unknown is never kept
    except ValueError:
        return False


def _value(value: float | int | str) -> str:
    if isinstance(value, str):
        return typeset(value)
    if isinstance(value, int):
        return str(value)
    if not math.isfinite(value):
        return {math.inf: "∞", -math.inf: "−∞"}.get(value, "not a number")
    return typeset(f"{value:.4g}")
