"""The sliders: which key of the specification each one sets, in what unit, from where to where."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped

Value = float | tuple[float, float]
"""What a slider shows: one number, or the two ends of a range."""


@dataclass(frozen=True)
class Knob:
    """One slider.

    Attributes:
        key: of the specification.
        label: on screen.
        unit: shown.
        low: its left end, in the unit shown.
        high: its right end.
        step: between two values.
        factor: shown value over the specification's.
        free: position that leaves the key out, or None where it cannot be left out.
        hint: what it does.
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    factor: float
    free: float | None
    hint: str

    def shown(self, specification: GaitSpecification) -> Value:
        """Where the slider stands for a specification, at the nearest of its values."""
        value = getattr(specification, self.key)
        if value is None:
            assert self.free is not None, self.key
            return self.free
        if isinstance(value, tuple):
            return self._nearest(value[0]), self._nearest(value[1])
        return self._nearest(float(value))

    def text(self, value: Value) -> str:
        """Label for a value: viser writes single values beside the slider, the ends of a range it does not."""
        if isinstance(value, tuple):
            return f"{self.label} {value[0]:.2f}–{value[1]:.2f} {self.unit}"
        return f"{self.label}: free" if value == self.free else f"{self.label} [{self.unit}]"

    def applied(self, specification: GaitSpecification, value: Value) -> GaitSpecification:
        """The specification with the slider at a value.

        Raises:
            SpecificationError: the specification refuses it, or the slider has no such place.
        """
        table: dict[str, Any] = specification.as_dict()
        if isinstance(value, tuple):
            table[self.key] = [round(part / self.factor, 12) for part in value]
        elif self.free is not None and abs(value - self.free) < 0.5 * self.step:
            table.pop(self.key, None)
        else:
            table[self.key] = round(value / self.factor, 12)
        changed = GaitSpecification.from_dict(table)
        slack = 1e-9 * self.step  # of rounding
        for part in value if isinstance(value, tuple) else (value,):
            if not self.low - slack <= part <= self.high + slack:
                raise SpecificationError(
                    f"{self.key}: the slider stands from {self.low:g} to {self.high:g} {self.unit}, not at {part:g}"
                )
        return changed

    def _nearest(self, value: float) -> float:
        steps = round((float(np.clip(value * self.factor, self.low, self.high)) - self.low) / self.step)
        return round(self.low + steps * self.step, 9)


def knobs_for(biped: FrontalBiped) -> tuple[Knob, ...]:
    """The sliders of a robot; ranges of width and FRI margin follow its size."""
    degree = 180.0 / np.pi
    hip, sole = biped.hip_width, biped.sole[1] - biped.sole[0]
    widest = float(np.ceil(300.0 * hip) / 100.0)
    narrowest = float(np.floor(50.0 * hip) / 100.0)
    margin = float(max(1.0, np.floor(400.0 * sole)))
    return (
        Knob("max_pelvis_roll", "pelvis roll", "deg", 2.0, 20.0, 0.5, degree, 20.0,
             "the pelvis rolls no more than this; 20: free"),
        Knob("step_duration", "time", "s", 0.2, 1.2, 0.01, 1.0, None, "shortest and longest step [C09]"),
        Knob("step_width", "width", "m", narrowest, widest, 0.01, 1.0, None, "distance between the ankles"),
        Knob("swing_clearance", "clearance", "mm", 0.0, 40.0, 1.0, 1e3, None,
             "height of the swing sole at the reversal [C05]"),
        Knob("friction", "friction", "-", 0.1, 1.0, 0.02, 1.0, None, "coefficient of friction [C06, C07]"),
        Knob("fri_margin", "FRI margin", "mm", 0.0, margin, 0.5, 1e3, None,
             "the FRI keeps this distance from the ends of the sole [C06]"),
        Knob("touchdown_speed", "touchdown", "m/s", 0.0, 0.3, 0.01, 1.0, None,
             "both ends of the sole come down at least this fast [C04]"),
        Knob("min_energy_margin", "energy margin", "-", 0.0, 3.0, 0.1, 1.0, 0.0,
             "energy to spare before tipping outwards, over the orbit's; 0: free"),
    )  # fmt: skip
