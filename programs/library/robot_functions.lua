---@meta
-- Robot programs: what every function does, for the Lua language server. Generated; do not edit:
-- lua_meta > programs/library/robot_functions.lua, or lua_meta --robot NAME for one robot's axes.

---@alias Pose number[] {x, y, z, phi1, phi2, phi3}: metres and degrees

---Switches an output while the robot moves: one place, one output, its value.
---@class PathSwitch
---@field distance_before_end? number m, on the way of the tool
---@field distance_after_start? number m, on the way of the tool
---@field time_before_end? number s
---@field time_after_start? number s
---@field output? integer digital output
---@field analog_output? integer analog output
---@field value boolean|number

---@class CartesianOptions
---@field blend? number m, zone in which the corner to the next motion may be cut
---@field on_path? PathSwitch|PathSwitch[]

---@class JointOptions
---@field jointBlend? number deg, zone in which the corner to the next motion may be cut
---@field on_path? PathSwitch|PathSwitch[]

---Moves the tool on a straight line to a pose; returns when the robot stands there.
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@param options? CartesianOptions
---@overload fun(pose: Pose, options?: CartesianOptions)
function ptpCartesianSpace(x, y, z, phi1, phi2, phi3, options) end

---Moves all axes together to joint angles; returns when the robot stands there.
---@param q1 number joint angle, in metres for a sliding axis (deg (m))
---@param q2 number joint angle, in metres for a sliding axis (deg (m))
---@param q3 number joint angle, in metres for a sliding axis (deg (m))
---@param q4 number joint angle, in metres for a sliding axis (deg (m))
---@param q5 number joint angle, in metres for a sliding axis (deg (m))
---@param q6 number joint angle, in metres for a sliding axis (deg (m))
---@param options? JointOptions
---@overload fun(q1: number, q2: number, q3: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, q6: number, q7: number, options?: JointOptions)
---@overload fun(q: number[], options?: JointOptions)
function ptpJointSpaceAngles(q1, q2, q3, q4, q5, q6, options) end

---Moves all axes together to a pose; returns when the robot stands there.
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@param options? JointOptions
---@overload fun(pose: Pose, options?: JointOptions)
function ptpJointSpacePosition(x, y, z, phi1, phi2, phi3, options) end

---Moves the tool on an arc through `via` to `target`, each {x, y, z, phi1, phi2, phi3}.
---@param via Pose pose on the arc: its position is passed
---@param target Pose pose at the end of the arc
---@param options? CartesianOptions
function circCartesianSpace(via, target, options) end

---Moves the tool on a smooth curve through poses, each {x, y, z, phi1, phi2, phi3}.
---@param ... Pose|CartesianOptions pose on the curve
function splineCartesianSpace(...) end

---Moves the tool on a straight line, relative to the last target.
---@param x number way along x (m)
---@param y number way along y (m)
---@param z number way along z (m)
---@param phi1 number turn by orientation angle 1 (deg)
---@param phi2 number turn by orientation angle 2 (deg)
---@param phi3 number turn by orientation angle 3 (deg)
---@param frame? "base"|"tool" 'base' (default) or 'tool': whose axes are meant
---@param options? CartesianOptions
---@overload fun(pose: Pose, frame?: "base"|"tool", options?: CartesianOptions)
function linearRelative(x, y, z, phi1, phi2, phi3, frame, options) end

---Moves all axes together by joint angles, relative to the last target.
---@param q1 number way of the joint, in metres for a sliding axis (deg (m))
---@param q2 number way of the joint, in metres for a sliding axis (deg (m))
---@param q3 number way of the joint, in metres for a sliding axis (deg (m))
---@param q4 number way of the joint, in metres for a sliding axis (deg (m))
---@param q5 number way of the joint, in metres for a sliding axis (deg (m))
---@param q6 number way of the joint, in metres for a sliding axis (deg (m))
---@param options? JointOptions
---@overload fun(q1: number, q2: number, q3: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, q6: number, q7: number, options?: JointOptions)
---@overload fun(q: number[], options?: JointOptions)
function ptpJointSpaceAnglesRelative(q1, q2, q3, q4, q5, q6, options) end

---Sets the tool: its tip seen from the flange (tool0); poses are of the tip.
---@param x number x of the frame (m)
---@param y number y of the frame (m)
---@param z number z of the frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@overload fun(pose: Pose)
function setTool(x, y, z, phi1, phi2, phi3) end

---Sets the base: a frame seen from the robot's base; poses are seen from it.
---@param x number x of the frame (m)
---@param y number y of the frame (m)
---@param z number z of the frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@overload fun(pose: Pose)
function setBase(x, y, z, phi1, phi2, phi3) end

---Sets what orientation angles mean; without it they follow the robot's maker.
---@param convention "zyx"|"xyz"|"zyz"|"XYZ"|"rotation_vector" one of zyx, xyz, zyz, XYZ, rotation_vector
function setOrientationConvention(convention) end

---Sets what the flange carries, when the robot stands; it counts in all torques.
---@param mass number mass of what the flange carries: tool and workpiece (kg)
---@param x? number x of its centre of mass, seen from tool0 (m)
---@param y? number y of its centre of mass, seen from tool0 (m)
---@param z? number z of its centre of mass, seen from tool0 (m)
function setPayload(mass, x, y, z) end

---Scales the speed, also of the motion under way; 0 stands still.
---@param value number speed scale of all motions, 0 to 1, at once
function setOverride(value) end

---Sets speed limits of the next motions; nil leaves one as it is.
---@param fraction? number part of the axes' limits of speed
---@param cartesian? number speed of the tool on Cartesian paths (m/s)
---@param rotation? number angular speed of the tool on Cartesian paths (deg/s)
function setSpeed(fraction, cartesian, rotation) end

---Sets acceleration limits of the next motions; nil leaves one as it is.
---@param fraction? number part of the axes' limits of acceleration
---@param cartesian? number acceleration of the tool on Cartesian paths (m/s^2)
---@param rotation? number angular acceleration of the tool on Cartesian paths (deg/s^2)
function setAcceleration(fraction, cartesian, rotation) end

---Reads where the joints are, in degrees, in metres for sliding axes.
---@return number[] # a table of n numbers
function getJointAngles() end

---Reads where the tool is, seen from the base: {x, y, z, phi1, phi2, phi3}.
---@return number[] # a table of 6 numbers
function getCartesianPosition() end

---Switches a digital output.
---@param index integer number of the output, from 1
---@param value boolean|0|1 0 or false: off, 1 or true: on
function setDigitalOutput(index, value) end

---Reads a digital input.
---@param index integer number of the input, from 1
---@return boolean # true or false
function getDigitalInput(index) end

---Sets an analog output.
---@param index integer number of the output, from 1
---@param value number value of the output
function setAnalogOutput(index, value) end

---Reads an analog input.
---@param index integer number of the input, from 1
---@return number # a number
function getAnalogInput(index) end

---Waits until a digital input has a value.
---@param index integer number of the input, from 1
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param timeout? number longest wait; without one it waits for ever (s)
---@return boolean # true, or false after `timeout`
function waitDigitalInput(index, value, timeout) end

---Waits until an analog input compares: waitAnalogInput(1, '>', 2.5).
---@param index integer number of the input, from 1
---@param comparison "<"|"<="|">"|">="|"=="|"~=" one of < <= > >= == ~=
---@param value number what the input is compared with
---@param timeout? number longest wait; without one it waits for ever (s)
---@return boolean # true, or false after `timeout`
function waitAnalogInput(index, comparison, value, timeout) end

---Switches a digital output on, and off again after a time; the program goes on meanwhile.
---@param index integer number of the output, from 1
---@param time number how long it is on (s)
function pulseDigitalOutput(index, time) end

---Lets a change of an input interrupt the program: the robot brakes on its path, `handler` runs, the motion goes on, or ends there if it returned 'abort'.
---@param index integer number of the input, from 1
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param handler fun(): "abort"|nil called at the change; it may return 'abort'
function onDigitalInput(index, value, handler) end

---Runs another program as subprogram; it has the same globals, and further arguments as `...`.
---@param program string file of the subprogram, seen from the folder of the main program
---@param ... any
---@return ... # what the subprogram returns
function call(program, ...) end

---Writes where the robot is to the points file under a name.
---@param name string name of the point
function teach(name) end

---Reads a taught point: its joint angles, and the pose of the flange {x, y, z, phi1, phi2, phi3}.
---@param name string name of the point
---@return number[], number[] # two tables
function getTaughtPoint(name) end

---Lets `reference_pose` guide the robot (state TRAJECTORY).
---@param time number longest time of it (s)
---@param index? integer number of a digital input that ends it
---@param value? boolean|0|1 the value of it that does
---@return boolean # true if the input ended it, false after `time`
function followReference(time, index, value) end

---Lets a person jog the robot (state TEACH).
---@param time number longest time of it (s)
---@param index? integer number of a digital input that ends it
---@param value? boolean|0|1 the value of it that does
---@return boolean # true if the input ended it, false after `time`
function jog(time, index, value) end

---Waits.
---@param time number how long, not counting pauses (s)
function wait(time) end

---Writes a line to the program's output.
---@param string any any values; several are separated by tabs
function print(string) end
