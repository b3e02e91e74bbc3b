"""What reports hold, as JSON has it."""

import math
from collections.abc import Mapping
from enum import Enum
from typing import Any


def for_json(value: Any) -> Any:
    """Numbers that do not exist (nan, infinite) become null, members of enums their values, tuples lists."""
    if isinstance(value, Mapping):
        return {key: for_json(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [for_json(part) for part in value]
    if isinstance(value, Enum):
        return value.value
    return None if isinstance(value, float) and not math.isfinite(value) else value
