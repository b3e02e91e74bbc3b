"""Gaits with a finite double support that the tests share, designed once a process (10 to 60 s of CPU each)."""

from dataclasses import replace
from functools import cache

from frontal_biped.design.support_design import SupportDesign, design_support_gait
from frontal_biped.gait.specification import default_specification
from frontal_biped.gait.support_gait import SupportSpecification
from frontal_biped.model.catalogue import biped_of

RANGES = {"frontal_biped": 0.04, "talos_full": 0.03, "g1": 0.03}
"""Least range of beta [rad]: wider than the default, so that an error of the ankle is a small part of a phase."""


@cache
def designed(name: str) -> SupportDesign:
    """The design of a robot by name."""
    biped = biped_of(name)
    bounds = replace(default_specification(biped), min_phase_range=RANGES[name])
    return design_support_gait(biped, SupportSpecification(bounds))
