"""The walking controller of the whole robot in space: from sensor readings to the torques of every joint."""
