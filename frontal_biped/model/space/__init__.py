"""The robot free in space: every joint on a floating base, and the frontal plane seen in it."""
