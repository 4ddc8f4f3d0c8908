"""RobotNodes: a robot and its controller as the objects of OPC 40010-1, with the values of a state."""

from __future__ import annotations

import datetime as dt
from fractions import Fraction
from importlib.metadata import version
from pathlib import Path
from typing import Final

import numpy as np
from asyncua import ua

from robots_controller.opcua.address_space.channel_nodes import ChannelNodes
from robots_controller.opcua.address_space.companion_types import DEVICE_SET, DI, Member
from robots_controller.opcua.address_space.instances import Instances
from robots_controller.opcua.address_space.node_writer import NodeWriter
from robots_controller.opcua.address_space.program_nodes import ProgramNodes
from robots_controller.opcua.address_space.task_nodes import TaskNodes
from robots_controller.opcua.server_settings import Nameplate
from robots_controller.opcua.task_control import TaskControl
from robots_controller.pendant.pendant_state import PendantState
from robots_core.blocks.multibody.payload import Payload
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

SYSTEM: Final = 'MotionDeviceSystem'
PRODUCT: Final = 'robots_controller'
INFORMATIONAL: Final = (
    'Informational: what the controller reports. Not a safety function, and no part of a safety function.'
)
MODES: Final = {
    OperatingMode.T1: 'MANUAL_REDUCED_SPEED',
    OperatingMode.T2: 'MANUAL_HIGH_SPEED',
    OperatingMode.AUTOMATIC: 'AUTOMATIC',
    OperatingMode.REMOTE: 'AUTOMATIC_EXTERNAL',
    None: 'OTHER',
}
CONTROLLER_PARTS: Final = ('Components', 'ParameterSet', 'Programs', 'StartUpTime')
"""Optional ones that it has."""
UNITS: Final = {
    'rad': ('C81', 'radian'),
    'm': ('MTR', 'metre'),
    'rad/s': ('2A', 'radian per second'),
    'm/s': ('MTS', 'metre per second'),
    'kg': ('KGM', 'kilogram'),
    '°C': ('CEL', 'degree Celsius'),
}
"""Codes of units (UNECE recommendation 20), and their names."""
RANGE: Final = Member('ua:EURange', 0, 'property', 'ua:Range')
LARGEST_RATE: Final = 65535  # of an UInt16
LARGEST_DENOMINATOR: Final = 10_000


class RobotNodes:
    """Adds the nodes to a server, and keeps their values."""

    def __init__(
        self,
        server: object,
        namespace: int,
        robot: BaseRobotModel,
        nameplate: Nameplate,
        *,
        programs: Path,
        control: TaskControl,
    ) -> None:
        self._made = Instances(NodeWriter(server, namespace))
        self._robot, self._plate = robot, nameplate
        device = robot.name.replace('/', '_')
        self._device = f'{SYSTEM}/MotionDevices/{device}'
        self._controller = controller = f'{SYSTEM}/Controllers/Controller'
        self._safety = f'{SYSTEM}/SafetyStates/SafetyState'
        self._programs = ProgramNodes(self._made, f'{controller}/Programs', programs)
        self._task = TaskNodes(self._made, f'{controller}/TaskControls/TaskControl', self._programs, control)
        self.channels: Final = ChannelNodes(self._made, f'{controller}/Components/InputsAndOutputs')

    async def build(self) -> None:
        """Add all nodes but those of inputs and outputs, which are added when they are known."""
        made = self._made
        writer = made.writer
        await writer.add_types()
        device_set = ua.NodeId(DEVICE_SET, await writer.server.get_namespace_index(DI))
        await writer.add(
            device_set,
            writer.browse_name('di:DeviceSet'),
            ua.NodeId(ua.ObjectIds.ObjectsFolder),
            ua.ObjectAttributes(),
            reference='ua:Organizes',
            type_name='ua:BaseObjectType',
        )
        await made.add(SYSTEM, 'MotionDeviceSystemType', parent=device_set, optional=('ComponentName',))
        await made.write(f'{SYSTEM}/ComponentName', self._robot.name)
        await self._add_device()
        await self._add_controller()
        await made.add(self._safety, 'SafetyStateType', description=INFORMATIONAL)
        await writer.refer(made.id(self._controller), 'Controls', made.id(self._device))
        await writer.refer(made.id(self._controller), 'HasSafetyStates', made.id(self._safety))
        await writer.refer(made.id(self._task.path), 'Controls', made.id(self._device))
        await made.write(f'{self._device}/TaskControlReference', made.id(self._task.path))

    async def update(self, state: PendantState) -> None:
        """Give the variables the values of a state; what is not known yet stays null."""
        made, device = self._made, self._device
        motion = {'InControl': state.drives_on, 'SpeedOverride': 100.0 * state.override}
        await made.write_all(f'{device}/ParameterSet', motion)
        for quantity, numbers in (('ActualPosition', state.q), ('ActualSpeed', state.q_dot)):
            for axis, value in zip(self._axes, () if numbers is None else numbers.tolist(), strict=False):
                await made.write(f'{device}/Axes/{axis}/ParameterSet/{quantity}', value)
        for axis, rate in zip(self._axes, self._load_rates(state.torque), strict=False):
            await made.write(f'{device}/PowerTrains/{axis}/Motor/ParameterSet/EffectiveLoadRate', rate)
        await self._write_load(state.payload)
        safety = {
            'OperationalMode': MODES[state.mode],
            'EmergencyStop': bool(state.fault) and state.emergency_stop,
            'ProtectiveStop': bool(state.fault) and not state.emergency_stop,
        }
        await made.write_all(f'{self._safety}/ParameterSet', safety)
        await made.write(f'{self._controller}/CurrentUser/Level', state.commander.value)
        await self._task.update(state.program)
        await self.channels.update(state.io)
        await self._programs.update()

    # -- the robot ----------------------------------------------------------------------------------------

    @property
    def _axes(self) -> tuple[str, ...]:
        return self._robot.axes_data.names

    def _load_rates(self, torque: Array | None) -> list[int]:
        if torque is None:
            return []
        rates = np.rint(100.0 * np.abs(torque) / self._robot.axes_data.effort)
        return [int(min(rate, LARGEST_RATE)) for rate in rates]

    async def _add_device(self) -> None:
        made, device, plate, axes = self._made, self._device, self._plate, self._robot.axes_data
        await made.add(device, 'MotionDeviceType', optional=('InControl', 'FlangeLoad', 'CenterOfMass'))
        values = {
            'Manufacturer': plate.manufacturer,
            'Model': plate.model or self._robot.name,
            'SerialNumber': plate.serial_number,
            'ProductCode': plate.product_code,
            'MotionDeviceCategory': 'OTHER' if any(axes.prismatic) else 'ARTICULATED_ROBOT',
            'FlangeLoad/Mass/EngineeringUnits': _unit('kg'),
        }
        await made.write_all(device, values)
        for index, name in enumerate(axes.names):
            await self._add_axis(index, f'{device}/Axes/{name}')
            await self._add_power_train(index, f'{device}/PowerTrains/{name}', f'{device}/Axes/{name}')

    async def _add_axis(self, index: int, path: str) -> None:
        made, axes = self._made, self._robot.axes_data
        await made.add(path, 'AxisType', optional=('ActualSpeed',))
        profile = 'LINEAR' if axes.prismatic[index] else 'ROTARY'
        await made.write(f'{path}/MotionProfile', profile + '_ENDLESS' * bool(axes.continuous[index]))
        ranges = {
            'ActualPosition': ('position', axes.lower[index], axes.upper[index]),
            'ActualSpeed': ('velocity', -axes.velocity[index], axes.velocity[index]),
        }
        for name, (quantity, low, high) in ranges.items():
            variable = f'{path}/ParameterSet/{name}'
            await made.write(f'{variable}/EngineeringUnits', _unit(axes.unit(index, quantity)))
            await made.add_variable(f'{variable}/EURange', RANGE)
            await made.write(f'{variable}/EURange', ua.Range(Low=float(low), High=float(high)))

    async def _add_power_train(self, index: int, path: str, axis: str) -> None:
        made = self._made
        train = await made.add(path, 'PowerTrainType')
        await made.add(f'{path}/Motor', 'MotorType', optional=('EffectiveLoadRate',))
        temperature = f'{path}/Motor/ParameterSet/MotorTemperature'
        await made.write(f'{temperature}/EngineeringUnits', _unit('°C'))
        ratio = float(self._robot.axes_data.gear_ratio[index])
        if np.isfinite(ratio):
            await made.add(f'{path}/Gear', 'GearType')
            exact = Fraction(ratio).limit_denominator(LARGEST_DENOMINATOR)
            value = ua.RationalNumber(Numerator=exact.numerator, Denominator=exact.denominator)
            await made.write(f'{path}/Gear/GearRatio', value)
        await made.writer.refer(train, 'Moves', made.id(axis))
        await made.writer.refer(made.id(axis), 'Requires', train)

    async def _write_load(self, payload: Payload) -> None:
        center = ua.ThreeDCartesianCoordinates(*payload.center.tolist())
        values = {'Mass': payload.mass, 'CenterOfMass': ua.ThreeDFrame(CartesianCoordinates=center)}
        await self._made.write_all(f'{self._device}/FlangeLoad', values)

    # -- its controller -----------------------------------------------------------------------------------

    async def _add_controller(self) -> None:
        made, path = self._made, self._controller
        await made.add(path, 'ControllerType', optional=CONTROLLER_PARTS)
        await made.write(f'{path}/ParameterSet/StartUpTime', dt.datetime.now(dt.UTC))
        software = f'{path}/Software/{PRODUCT}'
        await made.add(software, 'di:SoftwareType')
        await made.write(f'{software}/SoftwareRevision', version(PRODUCT))
        for product in (path, software):
            await made.write_all(product, {'Manufacturer': 'Robots', 'Model': PRODUCT})
        await self._task.build(made.id(self._device))
        await self.channels.build()
        await self._programs.build()


def _unit(text: str) -> ua.EUInformation:
    code, name = UNITS[text]
    return ua.EUInformation(
        NamespaceUri='http://www.opcfoundation.org/UA/units/un/cefact',
        UnitId=int.from_bytes(code.encode(), 'big'),
        DisplayName=ua.LocalizedText(text),
        Description=ua.LocalizedText(name),
    )
