"""A custom planner: all axes follow one polynomial of fifth order (docs/how_to/add_a_planner.md)."""

import numpy as np

from robots_core import Pose, load_robot_model
from robots_core.validation import Array
from robots_planning import Trajectory, TrajectoryGenerator, verify


class SmoothJoint(TrajectoryGenerator):
    """All axes move from rest to rest together, with one polynomial of fifth order."""

    kinds = ('joint', 'joint_to_pose')

    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_pose`."""
        return self.plan_to_joints(start, self.reach(target, start))

    def plan_to_joints(self, start: Array, target: Array) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_joints`."""
        way, still = np.abs(target - start), np.zeros((2, len(start)))
        # Its largest velocity is 15/8 of the mean, its largest acceleration 10/sqrt(3) times way/duration^2.
        by_velocity = 15.0 / 8.0 * way / self.velocity
        by_acceleration = np.sqrt(10.0 / np.sqrt(3.0) * way / self.acceleration)
        duration = max(by_velocity.max(), by_acceleration.max(), 0.01)
        return Trajectory(np.array([0.0, duration]), np.array([start, target]), still, still)


def main() -> None:
    """Plan a motion of a KUKA KR 210 and hold it to the limits of the robot."""
    robot = load_robot_model('kuka_kr210_r2700')
    plan = SmoothJoint(robot).generate(robot.home, np.radians([60.0, -60.0, 70.0, 20.0, 60.0, 0.0]))
    print(f'{plan.duration:.2f} s;', verify(plan, robot).describe())


if __name__ == '__main__':
    main()
