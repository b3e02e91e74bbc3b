"""Gains for torques that are held for a period."""


def sampled_frequency(period: float) -> float:
    """Natural frequency of the error dynamics for torques held for a period [rad/s]: a tenth of the rate, at most 100.

    Held torques leave an error at every impact, when the old stance ankle's torque acts on a light swing foot; it must
    be gone within the phase. On the feet of G1 and iCub 30 rad/s are too slow for that.
    """
    return min(100.0, 0.1 / period)
