"""Where the robot is told to go: the words of a path, and the steps that they become."""
