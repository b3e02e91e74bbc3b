"""Everything the package raises on purpose. Messages name the place, the value and the remedy in one line."""


class FrontalBipedError(Exception):
    """Base of all errors raised on purpose by this package."""


class RobotError(FrontalBipedError):
    """A robot description or URDF that cannot be used."""


class HypothesisError(RobotError):
    """The robot breaks one of the robot hypotheses HR1 to HR5 of the paper.

    Attributes:
        hypothesis: which one, for example ``"HR3"``.
    """

    def __init__(self, hypothesis: str, message: str) -> None:
        super().__init__(f"{message} ({hypothesis})")
        self.hypothesis = hypothesis
        self._given = (hypothesis, message)

    def __reduce__(self) -> tuple[type["HypothesisError"], tuple[str, str]]:
        return type(self), self._given  # it comes back whole from a worker process


class SpecificationError(FrontalBipedError):
    """A gait specification with an unknown key, a wrong type or a value out of range."""


class GaitFileError(FrontalBipedError):
    """A gait file that cannot be read, or is not a gait."""


class TrajectoryFileError(FrontalBipedError):
    """A run file that cannot be read, or is not a recorded run."""


class DesignFailedError(FrontalBipedError):
    """A gait is needed to go on, and none was found; the message says what stands in the way."""


class UnreachablePoseError(FrontalBipedError):
    """No pose puts both feet flat on the ground at the asked distance."""


class ReversalError(FrontalBipedError):
    """The zero dynamics has no reversal point where one is needed."""


class ProofError(FrontalBipedError):
    """A certificate is none, was changed, or does not hold; or a proof cannot begin."""


class SimulationError(FrontalBipedError):
    """Settings of a simulation that contradict each other."""


class LibraryError(FrontalBipedError):
    """A gait library that is not there, holds something else, or cannot be built where it was asked for."""


class MissingExtraError(FrontalBipedError):
    """An optional dependency is needed; the message names the extra that brings it."""


class ScenarioError(FrontalBipedError):
    """A scenario with an unknown key, a wrong type, a value out of range, or parts that do not go together."""


class UnknownNameError(FrontalBipedError, KeyError):
    """A name, of a joint say, that something asked by name does not have; the message names one that it has."""

    __str__ = Exception.__str__  # a KeyError would put the message into quotes


class ControllerError(FrontalBipedError):
    """A user's controller that cannot be asked, or whose answer cannot be used; the message says what to return."""


class Interruption(KeyboardInterrupt):
    """Ctrl+C, or a signal that asks as politely, while a command works. Like Ctrl+C it is no Exception.

    Attributes:
        signal_number: which signal it was.
    """

    def __init__(self, signal_number: int) -> None:
        super().__init__(signal_number)
        self.signal_number = signal_number

    @property
    def exit_status(self) -> int:
        """Of a process that ends because of it, as shells have it."""
        return 128 + self.signal_number


def is_interruption(error: BaseException) -> bool:
    """Does an error mean that the user wants an end, rather than that something else ended?

    A class of somebody else's that is derived from KeyboardInterrupt is an error like any other.
    """
    return type(error) in (KeyboardInterrupt, Interruption)
