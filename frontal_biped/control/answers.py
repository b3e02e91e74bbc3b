"""What a controller that is an object may answer: checked where it drives a robot, for users write controllers too."""

import numpy as np

from frontal_biped.exceptions import ControllerError


def check_answer(answer: object, torques: str, count: int, asked: str, t: float) -> None:
    """Raise ControllerError, in one line, for an answer without torques that motors could give.

    Args:
        answer: of the controller.
        torques: attribute of the answer that holds them.
        count: how many there must be.
        asked: the method that was asked, for the message.
        t: when [s].
    """
    values = getattr(answer, torques, None)
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.shape == (count,) and np.isfinite(array).all():
        return
    told = (
        f"with {torques} = {' '.join(repr(values).split())[:60]}" if hasattr(answer, torques) else f"without {torques}"
    )
    raise ControllerError(
        f"the controller's {asked} at t = {t:.4f} s returned {type(answer).__name__} {told}; return an object whose"
        f" {torques} are {count} finite numbers (N m)"
    )
