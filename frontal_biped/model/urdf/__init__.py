"""From a URDF to the bodies of the frontal plane: read, describe, find legs and soles, lock, project, symmetrise."""
