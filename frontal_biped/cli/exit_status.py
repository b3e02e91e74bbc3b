"""What a command line comes to."""

SUCCESS = 0
TASK_FAILED = 1
"""No gait found, not certified, the robot fell, an expectation that does not hold."""
USAGE = 2
"""Bad input, told in one line."""
