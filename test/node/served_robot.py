"""A robot whose planner serves an action of control_msgs, and a client of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from builtin_interfaces.msg import Duration
from rclpy.action.client import ActionClient
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'ur5e'


class ServedRobot(Bench):
    """Planner, controller and drives, and a client of the action."""

    def __init__(self, runner: Any, action: Any, name: str) -> None:
        super().__init__(runner)
        self.action = action
        self.robot = load_robot_model(ROBOT)
        self.names = list(self.robot.axes_data.names)
        self.start_node(DriveNode, robot_model=ROBOT, **SPARSE)
        self.start_node(ControllerNode, robot_model=ROBOT, **LATE_DRIVES, **SPARSE)
        planner = self.start_node(PlanningNode, robot_model=ROBOT)
        self.references = self.collect(
            'joint_reference', JointTrajectory, read=lambda message: message.points[0]
        )
        self.client = ActionClient(self.peer, action, name)
        self.feedback: list[Any] = []
        self.wait(
            lambda: self.references and planner.reference() is not None and self.client.server_is_ready(),
            'the action',
        )

    @property
    def q(self) -> np.ndarray:
        """The newest reference."""
        return np.array(self.references[-1].positions)

    def points(self, *rows: np.ndarray, period: int = 2) -> JointTrajectory:
        """A trajectory with a point in each period, s."""
        points = [
            JointTrajectoryPoint(positions=doubles(q), time_from_start=Duration(sec=period * number))
            for number, q in enumerate(rows, 1)
        ]
        return JointTrajectory(joint_names=self.names, points=points)

    def send(self, trajectory: Any, **goal: Any) -> Any:
        """A goal that is accepted."""
        sent = self.asked(
            lambda: self.client.send_goal_async(
                self.action.Goal(trajectory=trajectory, **goal),
                feedback_callback=lambda message: self.feedback.append(message.feedback),
            )
        )
        assert sent.accepted
        return sent

    def asked(self, ask: Any) -> Any:
        """The answer to a request, sent in the thread that takes answers: the client expects that."""
        futures: list[Any] = []
        self.peer.executor.create_task(lambda: futures.append(ask()))
        self.wait(lambda: futures and futures[0].done(), 'the answer')
        return futures[0].result()

    def result(self, goal: Any) -> tuple[int, Any]:
        """Status and result of a goal."""
        answer = self.asked(goal.get_result_async)
        return answer.status, answer.result

    @property
    def moving(self) -> bool:
        """By the newest reference."""
        return any(self.references[-1].velocities)

    def until_moving(self) -> None:
        """Wait until it moves."""
        self.wait(lambda: self.moving, 'it moves')

    def until_at(self, target: np.ndarray) -> None:
        """Wait for the reference of a target that is reached; it comes on another topic than the result."""
        self.wait(lambda: np.abs(self.q - target).max() < 1e-4, 'the target')
