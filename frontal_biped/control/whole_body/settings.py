"""Gains, limits and weights of the whole-body program."""

from dataclasses import dataclass


@dataclass(frozen=True)
class WholeBodySettings:
    """How the whole body is driven, what it keeps, and what gives way to what.

    Errors of outputs, lengths, pelvis, swing sole, its foot's angles and posture die out critically damped, at these
    natural frequencies [rad/s].

    Attributes:
        output: of the paper's outputs.
        length: of the lengths of the virtual legs.
        length_softness: least share of the lengths' feedback after a landing [-].
        pelvis: of the pelvis' pitch and yaw.
        swing: of the swing sole's way forwards.
        foot: of the swing sole's pitch and yaw.
        posture: of every other joint.
        stance: rate at which a velocity of the stance foot dies out [1/s].
        friction: coefficient that the stance foot counts on [-].
        min_normal_force: share of the weight that stays on the stance foot [-].
        sole_share: share of the sole, from the ankle outwards in every direction, that the centre of pressure may use.
        torque_share: share of the torque limits that may be used.
        speed_share: share of the joints' largest speed that may be used.
        range_margin: kept from the ends of the joints' ranges [rad].
        limit_rate: at which a joint may approach the end of its range or its speed [1/s].
        solver: "exact", in the residuals of the rows (see `nearest`), or "proxqp", at every tick.
    """

    output: float = 60.0
    length: float = 45.0
    length_softness: float = 1.0
    pelvis: float = 20.0
    swing: float = 40.0
    foot: float = 40.0
    posture: float = 15.0
    stance: float = 20.0
    friction: float = 0.6
    min_normal_force: float = 0.1
    sole_share: float = 0.9
    torque_share: float = 1.0
    speed_share: float = 0.95
    range_margin: float = 0.01
    limit_rate: float = 50.0
    solver: str = "exact"
