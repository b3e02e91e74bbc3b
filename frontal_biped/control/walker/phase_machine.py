"""Rising, falling, landed: told from contact flags that chatter and rates that are noisy.

*Landing.* A falling robot lands when its swing foot touches the ground. A flag alone may be a bounce of the last
landing or a fault, so it counts at once only where the kinematics expects the ground, otherwise after it has been up
for some readings, and never before the foot has left the ground since the last landing. While rising the robot sways
away from the swing foot: a touch then is a scuff, and a landing only if it lasts.

*Reversal.* The rate of the stance ankle falls through zero; it must be below by more than the noise, and not in the
first moments after a landing, when it rings. A push may turn the robot outwards again: the same, in the other sense.
"""

from dataclasses import dataclass

from frontal_biped.control.interface import PhaseEvent
from frontal_biped.virtual_constraints.phase import FALLING, RISING


@dataclass(frozen=True)
class PhaseSettings:
    """When the phase machine believes what.

    Attributes:
        rate: hysteresis of the rate that tells a reversal, of the stance ankle [rad/s] or in space of the sway [m/s].
        dwell: time after a landing or a reversal before the next reversal [s].
        expected: height of the swing sole below which a touch is believed at once [m].
        plausible: height above which a touch is not believed at all [m].
        touch: time for which another touch must last while falling [s].
        scuff: time for which it must last while rising [s].
        lifted: time without a touch, or above ``standing``, after which a foot has left the ground [s].
        standing: height, by the joints, above where it stood up to which a foot that touches may not have left uneven
            ground yet [m].
    """

    rate: float = 0.01
    dwell: float = 0.03
    expected: float = 0.002
    plausible: float = 0.02
    touch: float = 0.002
    scuff: float = 0.02
    lifted: float = 0.003
    standing: float = 0.006


class PhaseMachine:
    """Phase of a step from readings.

    Args:
        period: time between readings [s].
        settings: when to believe what.

    Attributes:
        phase: rising or falling.
        early_landings: landings before the reversal.
        late_landings: landings at least ``settings.expected`` below the ground the robot knows of.
        scuffs: touches while rising that did not last.
    """

    def __init__(self, period: float, settings: PhaseSettings | None = None) -> None:
        self.period, self.settings = period, settings or PhaseSettings()
        self.early_landings = self.late_landings = self.scuffs = 0
        self.reset()

    def reset(self) -> None:
        """Right after a landing."""
        self.phase = RISING
        self._since = 0.0
        self._touching = self._free = 0.0
        self._scuffing = False  # is the present touch counted as one?
        self._lifted = False
        self._stood = 0.0

    def stands(self, height: float) -> None:
        """The foot that is to swing stands this high above the other one [m], as after a landing on uneven ground."""
        self._stood = max(height, 0.0)

    def landing(self, touches: bool, clearance: float) -> bool:
        """Take a reading of the swing foot; True where it has just landed.

        Args:
            touches: its contact flag.
            clearance: height of the lowest point of its sole, by the joints [m]; matters only where it touches.
        """
        settings, h = self.settings, self.period
        # leaky, so that a flag that drops out now and then still counts
        self._touching = self._touching + h if touches else max(0.0, self._touching - h)
        self._scuffing &= self._touching > 0.0
        if touches and clearance < self._stood + settings.standing:
            self._free = 0.0
        else:
            self._free += h
        self._lifted |= self._free > settings.lifted
        if not touches or not self._lifted or clearance > settings.plausible:
            return False
        rising = self.phase is RISING
        if rising and not self._scuffing:
            self.scuffs += 1
            self._scuffing = True
        needed = settings.scuff if rising else 0.0 if clearance < settings.expected else settings.touch
        if self._touching < needed:
            return False
        if rising:
            self.early_landings += 1
            self.scuffs -= 1
        elif clearance < -settings.expected:
            self.late_landings += 1
        self.reset()
        return True

    def turn(self, rate: float) -> PhaseEvent | None:
        """Take the rate of the stance ankle [rad/s], in space of the sway outwards [m/s]; the event if it turns."""
        self._since += self.period
        if self._since < self.settings.dwell:
            return None
        if self.phase is RISING and rate < -self.settings.rate:
            self.phase, self._since = FALLING, 0.0
            return PhaseEvent.REVERSAL
        if self.phase is FALLING and rate > self.settings.rate:
            self.phase, self._since = RISING, 0.0
            return PhaseEvent.TURNED_OUTWARDS
        return None
