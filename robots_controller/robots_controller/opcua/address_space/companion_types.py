"""Types of OPC UA for Robotics (OPC 40010-1, version 1.02) and Devices (OPC 10000-100) that are used here.

Names and numbers are those of the specifications; members that the specifications have besides are optional.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

DI: Final = 'http://opcfoundation.org/UA/DI/'
ROBOTICS: Final = 'http://opcfoundation.org/UA/Robotics/'
DEVICE_SET: Final = 5001
"""Number of the object of DI below which devices are found."""

Kind = Literal['property', 'variable', 'object', 'method']


@dataclass(frozen=True)
class Member:
    """What an object of a type has.

    Attributes:
        name: Browse name, with `di:` or `ua:` before it where it is not of Robotics.
        number: Of the declaration in its type.
        kind: Class of the node.
        type: Of a variable or property its data type, of an object its type.
        variable_type: Type of a variable.
        optional: An object may lack it.
        members: Of an object without a type of its own.
        is_list: Its values are lists.
    """

    name: str
    number: int
    kind: Kind
    type: str = ''
    variable_type: str = 'ua:BaseDataVariableType'
    optional: bool = False
    members: tuple[Member, ...] = ()
    is_list: bool = False


@dataclass(frozen=True)
class ObjectType:
    """A type of objects.

    Attributes:
        number: Of its node in its namespace.
        base: Name of the type that it extends.
        members: Of its objects, besides those of the base.
        abstract: Only objects of types that extend it exist.
    """

    number: int
    base: str
    members: tuple[Member, ...] = ()
    abstract: bool = False


def _type(number: int, base: str, *members: Member, abstract: bool = False) -> ObjectType:
    return ObjectType(number, base, members, abstract)


def _properties(serial: int, maker: int, model: int, code: int) -> tuple[Member, ...]:
    return (
        Member('di:Manufacturer', maker, 'property', 'ua:LocalizedText'),
        Member('di:Model', model, 'property', 'ua:LocalizedText'),
        Member('di:ProductCode', code, 'property', 'ua:String'),
        Member('di:SerialNumber', serial, 'property', 'ua:String'),
    )


def _objects(type_name: str, **numbers: int) -> tuple[Member, ...]:
    return tuple(Member(name, number, 'object', type_name) for name, number in numbers.items())


def _parameters(number: int, *members: Member) -> Member:
    return Member('di:ParameterSet', number, 'object', 'ua:BaseObjectType', members=members)


def _analog(name: str, number: int, *, optional: bool = False) -> Member:
    return Member(name, number, 'variable', 'ua:Double', 'ua:AnalogUnitType', optional)


def _state_machine(transition: int, reason: int) -> tuple[Member, ...]:
    return (
        Member(
            'ua:LastTransition', transition, 'variable', 'ua:LocalizedText', 'ua:FiniteTransitionVariableType'
        ),
        Member('LastTransitionReason', reason, 'variable', 'ua:Int16', 'ua:MultiStateValueDiscreteType'),
    )


_DIRECTORY_METHODS: Final = (
    Member('ua:CreateDirectory', 7015, 'method'),
    Member('ua:CreateFile', 7016, 'method'),
    Member('ua:Delete', 7017, 'method'),
    Member('ua:MoveOrCopy', 7018, 'method'),
)

OBJECT_TYPES: Final[Mapping[str, ObjectType]] = {
    'di:TopologyElementType': _type(
        1001,
        'ua:BaseObjectType',
        Member('di:ParameterSet', 5002, 'object', 'ua:BaseObjectType', optional=True),
        abstract=True,
    ),
    'di:ComponentType': _type(15063, 'di:TopologyElementType', abstract=True),
    'di:DeviceType': _type(1002, 'di:ComponentType', abstract=True),
    'di:SoftwareType': _type(
        15106,
        'di:ComponentType',
        Member('di:Manufacturer', 15129, 'property', 'ua:LocalizedText'),
        Member('di:Model', 15131, 'property', 'ua:LocalizedText'),
        Member('di:SoftwareRevision', 15133, 'property', 'ua:String'),
    ),
    'MotionDeviceSystemType': _type(
        1002,
        'di:ComponentType',
        *_objects('ua:FolderType', MotionDevices=5002, Controllers=5001, SafetyStates=5010),
        Member('di:ComponentName', 6171, 'property', 'ua:LocalizedText', optional=True),
    ),
    'MotionDeviceType': _type(
        1004,
        'di:ComponentType',
        *_properties(serial=16354, maker=16351, model=16353, code=16359),
        Member('MotionDeviceCategory', 16362, 'property', 'MotionDeviceCategoryEnumeration'),
        _parameters(
            5029,
            Member('InControl', 16364, 'variable', 'ua:Boolean', optional=True),
            Member('SpeedOverride', 16365, 'variable', 'ua:Double'),
        ),
        *_objects('ua:FolderType', Axes=15305, PowerTrains=16443),
        Member('FlangeLoad', 5091, 'object', 'LoadType', optional=True),
        Member('TaskControlReference', 6001, 'property', 'ua:NodeId'),
    ),
    'AxisType': _type(
        16601,
        'di:ComponentType',
        Member('MotionProfile', 16637, 'property', 'AxisMotionProfileEnumeration'),
        _parameters(
            16602,
            _analog('ActualPosition', 16662),
            _analog('ActualSpeed', 16668, optional=True),
        ),
    ),
    'PowerTrainType': _type(16794, 'di:ComponentType'),
    'MotorType': _type(
        1019,
        'di:ComponentType',
        *_properties(serial=17104, maker=17101, model=17103, code=17109),
        _parameters(
            5105,
            _analog('MotorTemperature', 6757),
            Member('EffectiveLoadRate', 6776, 'variable', 'ua:UInt16', optional=True),
        ),
    ),
    'GearType': _type(
        1022,
        'di:ComponentType',
        *_properties(serial=17155, maker=17152, model=17154, code=17160),
        Member('GearRatio', 15941, 'variable', 'ua:RationalNumber', 'ua:RationalNumberType'),
    ),
    'SafetyStateType': _type(
        1013,
        'di:ComponentType',
        _parameters(
            5016,
            Member('OperationalMode', 15912, 'variable', 'OperationalModeEnumeration'),
            Member('EmergencyStop', 15882, 'variable', 'ua:Boolean'),
            Member('ProtectiveStop', 15913, 'variable', 'ua:Boolean'),
        ),
    ),
    'ControllerType': _type(
        1003,
        'di:ComponentType',
        *_properties(serial=17240, maker=17237, model=17239, code=17245),
        Member('CurrentUser', 17249, 'object', 'UserType'),
        Member('Components', 17252, 'object', 'ua:FolderType', optional=True),
        *_objects('ua:FolderType', Software=15800, TaskControls=15826),
        Member('Programs', 5054, 'object', 'ua:FileDirectoryType', optional=True, members=_DIRECTORY_METHODS),
        _parameters(5004, Member('StartUpTime', 15366, 'variable', 'ua:DateTime', optional=True)),
    ),
    'AuxiliaryComponentType': _type(
        17725, 'di:DeviceType', Member('di:ProductCode', 17756, 'property', 'ua:String')
    ),
    'TaskControlType': _type(
        1011,
        'di:ComponentType',
        Member('di:ComponentName', 17873, 'property', 'ua:LocalizedText'),
        _parameters(
            15883,
            Member('TaskProgramName', 17874, 'variable', 'ua:String'),
            Member('TaskProgramLoaded', 17875, 'variable', 'ua:Boolean'),
            Member('ExecutionMode', 17876, 'variable', 'ExecutionModeEnumeration', optional=True),
        ),
        Member('TaskControlOperation', 5052, 'object', 'TaskControlOperationType', optional=True),
    ),
    'TaskControlOperationType': _type(
        1008,
        'ua:BaseObjectType',
        Member('MotionDevicesUnderControl', 6131, 'property', 'ua:NodeId', optional=True, is_list=True),
        Member('TaskControlStateMachine', 5051, 'object', 'TaskControlStateMachineType'),
    ),
    'OperationStateMachineType': _type(
        1006,
        'ua:FiniteStateMachineType',
        *_state_machine(6005, 6007),
        Member('PossibleStopModes', 6008, 'variable', 'ua:EnumValueType', optional=True, is_list=True),
        Member('ConfiguredDefaultStopMode', 6009, 'variable', 'ua:Int16', optional=True),
        *_objects('ua:StateType', Idle=5005, Ready=5006, Executing=5007),
        *_objects('ua:TransitionType', ReadyToIdle=5008, IdleToReady=5009, ExecutingToReady=5011),
        *_objects('ua:TransitionType', ReadyToExecuting=5012, ExecutingToIdle=5013, IdleToIdle=5014),
        Member('Start', 7001, 'method', optional=True),
        Member('Stop', 7002, 'method', optional=True),
        abstract=True,
    ),
    'TaskControlStateMachineType': _type(
        1025,
        'OperationStateMachineType',
        Member('ReadySubstateMachine', 5039, 'object', 'ReadySubstateMachineType', optional=True),
        Member('LoadByNodeId', 7010, 'method', optional=True),
        Member('LoadByName', 7011, 'method', optional=True),
        Member('UnloadProgram', 7012, 'method', optional=True),
        Member('UnloadByNodeId', 7013, 'method', optional=True),
        Member('UnloadByName', 7014, 'method', optional=True),
    ),
    'ReadySubstateMachineType': _type(
        1012,
        'ua:FiniteStateMachineType',
        *_state_machine(6044, 6046),
        *_objects('ua:StateType', AtProgramStart=5023, Suspended=5024),
        *_objects('ua:TransitionType', ProgramStartToSuspended=5025, SuspendedToProgramStart=5026),
        Member('ResetToProgramStart', 7003, 'method', optional=True),
    ),
    'LoadType': _type(
        1018,
        'ua:BaseObjectType',
        _analog('Mass', 6723),
        Member('CenterOfMass', 6013, 'variable', 'ua:ThreeDFrame', 'ua:ThreeDFrameType', optional=True),
    ),
    'UserType': _type(18175, 'ua:BaseObjectType', Member('Level', 18176, 'property', 'ua:String')),
}
"""By name, in an order in which each comes after its base."""

REFERENCE_TYPES: Final[Mapping[str, tuple[int, str]]] = {
    'Controls': (4002, 'IsControlledBy'),
    'Moves': (18178, 'IsMovedBy'),
    'Requires': (18179, 'IsRequiredBy'),
    'HasSafetyStates': (18182, 'SafetyStatesOf'),
}
"""Number and name in the other direction; all extend HierarchicalReferences."""

ENUMERATIONS: Final[Mapping[str, tuple[int, int, tuple[str, ...]]]] = {
    'ExecutionModeEnumeration': (18191, 18192, ('CYCLE', 'CONTINUOUS', 'STEP')),
    'MotionDeviceCategoryEnumeration': (
        18193,
        18194,
        (
            *('OTHER', 'ARTICULATED_ROBOT', 'SCARA_ROBOT', 'CARTESIAN_ROBOT', 'SPHERICAL_ROBOT'),
            *('PARALLEL_ROBOT', 'CYLINDRICAL_ROBOT'),
        ),
    ),
    'AxisMotionProfileEnumeration': (
        3008,
        6027,
        ('OTHER', 'ROTARY', 'ROTARY_ENDLESS', 'LINEAR', 'LINEAR_ENDLESS'),
    ),
    'OperationalModeEnumeration': (
        3006,
        6022,
        ('OTHER', 'MANUAL_REDUCED_SPEED', 'MANUAL_HIGH_SPEED', 'AUTOMATIC', 'AUTOMATIC_EXTERNAL'),
    ),
}
"""Number of the data type, number of its texts, and the texts, from 0 on."""

TRANSITION_REASONS: Final = ('Unknown', 'External', 'Direct', 'System', 'Error', 'Application')
"""Values of LastTransitionReason, from 0 on."""


def all_members(name: str) -> tuple[Member, ...]:
    """Members of the objects of a type, those of its bases first; it may declare those anew."""
    found = OBJECT_TYPES.get(name)
    if found is None:
        return ()
    members = {member.name: member for member in all_members(found.base)}
    return tuple((members | {member.name: member for member in found.members}).values())
