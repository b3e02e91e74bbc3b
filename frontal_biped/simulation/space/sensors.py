"""What stands between the true state of a free robot and its controller: noise of encoders and inertial unit."""

import pinocchio as pin

from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.simulation.sensors import Sensors
from frontal_biped.simulation.space.settings import SpatialSettings


class SpatialSensors:
    """Encoders, inertial unit and foot contacts of a free robot; the same for every engine.

    Args:
        settings: of the run.
    """

    def __init__(self, settings: SpatialSettings) -> None:
        self._velocity_noise = settings.velocity_noise
        self._joints = Sensors(settings.disturbances)

    def read(self, true: SpatialReading) -> SpatialReading:
        """What the sensors make of the true values; rates are left out where they must be estimated."""
        disturbances, normal = self._joints.disturbances, self._joints.generator.standard_normal
        positions, velocities = self._joints.joints(true.joint_positions), true.joint_velocities
        rotation, rates = true.base_rotation, true.base_angular_velocity
        if disturbances.imu_noise:
            rotation = rotation @ pin.exp3(disturbances.imu_noise * normal(3))
        if disturbances.gyro_noise:
            rates = rates + disturbances.gyro_noise * normal(3)
        if self._velocity_noise is None:
            velocities = None if disturbances.noisy_sensors else velocities
        elif self._velocity_noise and velocities is not None:
            velocities = velocities + self._velocity_noise * normal(len(velocities))
        return SpatialReading(true.time, positions, velocities, rotation, rates, true.contact)
