"""The walker: from sensor readings to torques, as on a robot."""
