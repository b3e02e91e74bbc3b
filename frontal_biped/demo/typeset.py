"""Formulas of plain text as HTML: the symbols of the paper, whichever way a table spells them."""

import html
import re

_GREEK = {"beta": "β", "delta": "δ", "zeta": "ζ", "kappa": "κ", "sigma": "σ", "tau": "τ"}
_WORD = re.compile(rf"(?<![A-Za-z])({'|'.join(_GREEK)})(?![a-z])")
_POWER_OF_TEN = re.compile(r"(?<![\w.])(-?\d+(?:\.\d+)?)e([+-]\d+)\b")
_SUBSCRIPT = re.compile(r"(?<![A-Za-z_])([A-Za-zα-ω])_([A-Za-z0-9]|FRI|max|min)(?![A-Za-z0-9_])")
_SUPERSCRIPT = re.compile(r"\^(-?\d+|[*+-])")
_SIGN_OF_SYMBOL = re.compile(r"(</sub>)([*-])(?=$|[\s,)])")
_MINUS = re.compile(r"(?<![\w)>])-(?=\d)")


def typeset(text: str) -> str:
    """HTML of a line of plain text: ``delta_f^2`` with letter, index and power, ``1.5e-13`` as a power of ten.

    Args:
        text: names, numbers and units as they are printed in a terminal. Names of more than one letter, such as
            ``max_pelvis_roll``, stay as they are.

    Returns:
        HTML; what is special to it is escaped.
    """
    marked = _WORD.sub(lambda found: _GREEK[found[1]], html.escape(text))
    marked = _POWER_OF_TEN.sub(lambda found: f"{found[1]} × 10<sup>{_signed(str(int(found[2])))}</sup>", marked)
    marked = _SUBSCRIPT.sub(r"\1<sub>\2</sub>", marked)
    marked = _SIGN_OF_SYMBOL.sub(lambda found: f"{found[1]}<sup>{_signed(found[2])}</sup>", marked)
    marked = _SUPERSCRIPT.sub(lambda found: f"<sup>{_signed(found[1])}</sup>", marked)
    return _MINUS.sub("−", marked)


def _signed(text: str) -> str:
    return text.replace("-", "−")
