"""The state of the studio as HTML: what the gait is worth, what certifies it, what stands in the way."""

import html

from frontal_biped.gait.check import ConstraintCheck, ConstraintReport
from frontal_biped.numerics.verdict import COLUMNS
from frontal_biped.studio.workbench import State

GOOD, BUSY, BAD, PLAIN = "#1a7f37", "#9a6700", "#c4231c", "#57606a"
"""Colours of what is as wanted, not yet, not so, and of what is said beside it."""


def headline(state: State) -> str:
    """Certificate, cost and orbit; progress while a design runs, the reason where there is no gait."""
    parts = []
    if state.designing:
        parts.append(box(BUSY, "designing", state.designing.removeprefix("designing: ")))
    elif state.explanation:
        text = "the gait on screen is the last that was found. " if state.gait is not None else ""
        parts.append(box(BAD, "no gait for this specification", text + state.explanation))
    elif state.gait is not None:
        parts.append(box(GOOD, "gait found", "C01–C09 kept on a dense grid, a simulated step returns"))
    gait = state.gait
    if gait is not None:
        before = f" (before: {state.previous_cost:.1f})" if state.previous_cost is not None else ""
        orbit = gait.orbit
        parts.append(
            f'<div style="font-size:1.25em;margin:.35em 0 .1em"><b>J = {orbit.cost:.2f}</b> N² m s'
            f'<span style="font-size:.75em;color:{PLAIN}">{before}</span></div>'
            f"<div>step {orbit.step_duration:.3f} s, {gait.step_width:.3f} m wide; multiplier {orbit.multiplier:.4f}"
            f"; designed in {state.seconds:.2f} s</div>"
        )
        parts.append(_certificate(state))
    return panel_text("".join(parts))


def margins(report: ConstraintReport | None) -> str:
    """The tightest margin of every constraint."""
    if report is None:
        return ""
    rows = []
    for code in dict.fromkeys(check.code for check in report.checks):
        check = min((c for c in report.checks if c.code == code), key=_tightness)
        colour = GOOD if check.satisfied else BAD
        cells = f"<td>{check.value:.3g}</td><td>{check.bound:.3g}</td><td>{check.margin:.2g}</td>"
        rows.append(
            f'<tr><td style="color:{colour}"><b>{html.escape(code)}</b></td><td style="text-align:left">'
            f"{html.escape(check.name)}</td>{cells}<td style='text-align:left'>{html.escape(check.unit)}</td></tr>"
        )
    head = "<tr><th></th><th style='text-align:left'>tightest point</th>"
    head += "".join(f"<th style='padding:0 .3em'>{word}</th>" for word in ("value", "bound", "margin", "")) + "</tr>"
    style = "overflow-wrap:normal;width:100%;border-collapse:collapse;text-align:right;font-size:.92em"
    return panel_text(f'<table style="{style}">{head}{"".join(rows)}</table>')


def push_text(state: State) -> str:
    """Outcome of the push, or what the second worker does."""
    if state.push:
        return panel_text(box(GOOD if state.push_recovered else BAD, *state.push.split(": ", 1)))
    if state.busy and not state.busy.startswith(("counting", "drawing", "proving", "writing")):
        return panel_text(box(BUSY, "pushing", state.busy))
    return panel_text(f'<span style="color:{PLAIN}">6 steps under the ankle stabiliser at 1 kHz, full model</span>')


def notice_text(state: State) -> str:
    """What was saved, or went wrong."""
    return panel_text(html.escape(state.notice))


def _certificate(state: State) -> str:
    found = state.certificate
    if found is None:
        return f'<div style="color:{PLAIN}">certificate: {html.escape(state.busy or "waiting")} …</div>'
    verdict = "certified in closed form" if found.certified else f"certified: {found.text}"
    colour = GOOD if found.certified else BAD
    lines = [f'<div style="color:{colour}"><b>{html.escape(verdict)}</b>, largest residual {found.residual:.0e}</div>']
    for title, text in found.rows:
        if title.startswith("Z("):
            short = text.split("; zeros")[0]
            lines.append(f'<div style="color:{PLAIN}">reversal, {html.escape(title)}: {html.escape(short)}</div>')
    return "".join([*lines, _proof(state)])


def _proof(state: State) -> str:
    """Statements with both verdicts."""
    if not state.proof:
        waiting = state.busy.startswith("proving")
        return f'<div style="color:{PLAIN}">{html.escape(state.busy)} …</div>' if waiting else ""
    rows = []
    for name, measured, proved in state.proof:
        colour = BAD if "CONTRADICTION" in proved else GOOD if proved == "proved" else PLAIN
        rows.append(
            f'<tr><td>{html.escape(name)}</td><td style="padding-right:.5em">{html.escape(measured)}</td>'
            f'<td style="color:{colour}"><b>{html.escape(proved)}</b></td></tr>'
        )
    head = "<tr>" + "".join(f'<th style="text-align:left;padding-right:.5em">{word}</th>' for word in COLUMNS) + "</tr>"
    return f'<table style="border-collapse:collapse;font-size:.92em;margin:.3em 0">{head}{"".join(rows)}</table>'


def _tightness(check: ConstraintCheck) -> float:
    return check.margin / check.scale


def box(colour: str, title: str, text: str) -> str:
    """A title and a line beside a bar of a colour."""
    return (
        f'<div style="border-left:4px solid {colour};padding:.25em .6em;background:{colour}14">'
        f'<b style="color:{colour}">{html.escape(title)}</b><br>{html.escape(text)}</div>'
    )


def panel_text(content: str) -> str:
    """HTML of the size and width of the panel."""
    return f'<div style="font-size:.85em;line-height:1.35;padding:0 .9em;overflow-wrap:anywhere">{content}</div>'
