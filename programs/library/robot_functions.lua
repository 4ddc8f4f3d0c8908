---@meta
-- Robot programs: what every function does, for the Lua language server. Generated; do not edit:
-- lua_meta > programs/library/robot_functions.lua, or lua_meta --robot NAME for one robot's axes.

---{x, y, z, phi1, phi2, phi3}: metres and degrees; `a * b` chains, b seen from a.
---@class Pose: number[]
---@field x number
---@field y number
---@field z number
---@field phi1 number
---@field phi2 number
---@field phi3 number
---@operator mul(Pose|number[]): Pose

---Switches an output while the robot moves: one place, one output, its value.
---@class PathSwitch
---@field distance_before_end? number m, along the tool path
---@field distance_after_start? number m, along the tool path
---@field time_before_end? number s
---@field time_after_start? number s
---@field output? integer|string digital output
---@field analog_output? integer|string analog output
---@field value boolean|number

---What ends a motion: one input or torque, and its value or bounds.
---@class Condition
---@field input? integer|string digital input
---@field value? boolean of the digital input, true by default
---@field analog_input? integer|string
---@field joint_torque? integer number of a joint, its torque in N m (N)
---@field above? number
---@field below? number

---@class CartesianOptions
---@field blend? number m, zone in which the corner to the next motion may be cut
---@field avoid? boolean|0|1 whether joint motions go around obstacles
---@field on_path? PathSwitch|PathSwitch[]

---@class JointOptions
---@field jointBlend? number deg, zone in which the corner to the next motion may be cut
---@field avoid? boolean|0|1 whether joint motions go around obstacles
---@field on_blocked? "stop"|"replan" what an obstacle does that comes into the path of a motion with avoid
---@field on_path? PathSwitch|PathSwitch[]

---Moves the tool on a straight line to a pose; returns when the robot stands there.
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@param options? CartesianOptions
---@overload fun(pose: Pose|number[], options?: CartesianOptions)
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
---@overload fun(pose: Pose|number[], options?: JointOptions)
function ptpJointSpacePosition(x, y, z, phi1, phi2, phi3, options) end

---Moves the tool on an arc through `via` to `target`, each {x, y, z, phi1, phi2, phi3}.
---@param via Pose|number[] pose on the arc: its position is passed
---@param target Pose|number[] pose at the end of the arc
---@param options? CartesianOptions
function circCartesianSpace(via, target, options) end

---Moves the tool on a smooth curve through poses, each {x, y, z, phi1, phi2, phi3}.
---@param ... Pose|number[]|CartesianOptions pose on the curve
function splineCartesianSpace(...) end

---Moves the tool on a straight line, relative to the last target.
---@param x number displacement along x (m)
---@param y number displacement along y (m)
---@param z number displacement along z (m)
---@param phi1 number turn by orientation angle 1 (deg)
---@param phi2 number turn by orientation angle 2 (deg)
---@param phi3 number turn by orientation angle 3 (deg)
---@param frame? "base"|"tool" 'base' (default) or 'tool': whose axes are meant
---@param options? CartesianOptions
---@overload fun(pose: Pose|number[], frame?: "base"|"tool", options?: CartesianOptions)
function linearRelative(x, y, z, phi1, phi2, phi3, frame, options) end

---Moves all axes together by joint angles, relative to the last target.
---@param q1 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param q2 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param q3 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param q4 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param q5 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param q6 number displacement of the joint, in metres for a sliding axis (deg (m))
---@param options? JointOptions
---@overload fun(q1: number, q2: number, q3: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, options?: JointOptions)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, q6: number, q7: number, options?: JointOptions)
---@overload fun(q: number[], options?: JointOptions)
function ptpJointSpaceAnglesRelative(q1, q2, q3, q4, q5, q6, options) end

---Moves until a condition holds: the robot brakes on its path. As moveUntil({input = 1}, linearRelative, 0, 0, -0.1, 0, 0, 0).
---@param condition Condition {input = index, value = true or false}, {analog_input = index, above | below = number}, or {joint_torque = joint, above | below = N m (N)}
---@param motion function function that moves the robot; its arguments follow
---@param ... any
---@return boolean, Pose, Pose|nil # whether it held, the pose where the robot stands, the pose where it held
function moveUntil(condition, motion, ...) end

---Sets the tool centre point, as a pose in tool0 (the flange); all poses are those of this point. A name alone, `setTool('gripper')`, is that of a tool of the frames file; where that has its payload, it is set too, as by setPayload.
---@param x number x of the frame (m)
---@param y number y of the frame (m)
---@param z number z of the frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@overload fun(pose: Pose|number[])
---@overload fun(name: string)
function setTool(x, y, z, phi1, phi2, phi3) end

---Sets the base frame, as a pose in the robot's own base; all poses are relative to it. A name alone, `setBase('table')`, is that of a base of the frames file.
---@param x number x of the frame (m)
---@param y number y of the frame (m)
---@param z number z of the frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@overload fun(pose: Pose|number[])
---@overload fun(name: string)
function setBase(x, y, z, phi1, phi2, phi3) end

---Sets what orientation angles mean; without it they follow the robot's maker.
---@param convention "zyx"|"xyz"|"zyz"|"XYZ"|"rotation_vector" one of zyx, xyz, zyz, XYZ, rotation_vector
function setOrientationConvention(convention) end

---Sets which part of a pose motions reach; the default depends on the number of axes. Valid are 'pose', 'position', and 'directions', which is the position and the part of the orientation that the arm can hold.
---@param hold "pose"|"directions"|"position" one of pose, directions, position
function setHold(hold) end

---Reads the tool.
---@return Pose # a pose
function getTool() end

---Reads the base.
---@return Pose # a pose
function getBase() end

---Reads the payload: {mass, x, y, z}, kg and m.
---@return number[] # a table of 4 numbers
function getPayload() end

---Sets the payload, mass and centre of mass, when the robot stands; it counts in all torques.
---@param mass number mass of what the flange carries: tool and workpiece (kg)
---@param x? number x of its centre of mass, seen from tool0 (m)
---@param y? number y of its centre of mass, seen from tool0 (m)
---@param z? number z of its centre of mass, seen from tool0 (m)
function setPayload(mass, x, y, z) end

---Scales the speed of all motions, also of the one under way; at 0 the robot stands still.
---@param value number speed scale of all motions, 0 to 1, at once
function setOverride(value) end

---Sets speed limits of the next motions; nil leaves one as it is.
---@param fraction? number part of the axes' limits of speed
---@param cartesian? number speed of the tool on Cartesian paths (m/s)
---@param rotation? number angular speed of the tool on Cartesian paths (deg/s)
function setSpeed(fraction, cartesian, rotation) end

---Chooses the planners of the next motions; nil leaves one as it is.
---@param joint? string planner of joint motions
---@param cartesian? string planner of Cartesian motions
function setPlanner(joint, cartesian) end

---Chooses the configuration in which joint motions reach a pose; without one, the nearest.
---@param configuration? "front/up/no_flip"|"front/up/flip"|"front/down/no_flip"|"front/down/flip"|"back/up/no_flip"|"back/up/flip"|"back/down/no_flip"|"back/down/flip" as 'front/up/no_flip'
function setConfiguration(configuration) end

---Switches jerk limits on or off for Cartesian motions, blended chains and motions with `avoid`.
---@param value boolean|0|1 0 or false: off, 1 or true: on
function setJerkLimited(value) end

---Lets joint motions go around obstacles. A search counts postures, 25 000 a second of its budget, and not time: a slow computer finds the same. An obstacle that comes into the path of such a motion stops it; with 'replan' it then goes around that from where the robot stands, at most `most` times (5).
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param budget? number longest search for a path around obstacles (s)
---@param on_blocked? "stop"|"replan" one of stop, replan
---@param most? integer how often one motion may be replanned
function setAvoid(value, budget, on_blocked, most) end

---Sets acceleration limits of the next motions; nil leaves one as it is.
---@param fraction? number part of the axes' limits of acceleration
---@param cartesian? number acceleration of the tool on Cartesian paths (m/s^2)
---@param rotation? number angular acceleration of the tool on Cartesian paths (deg/s^2)
function setAcceleration(fraction, cartesian, rotation) end

---Lets a change of an input interrupt the program. The robot brakes on its path, `handler` runs, and the motion continues, or ends there if the handler returned 'abort'.
---@param index integer|string number of the input, from 1, or its name
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param handler fun(): "abort"|nil called at the change; it may return 'abort'
---@param priority? integer 1 is the most urgent, 100 the default
---@return integer # the interrupt's number
function onDigitalInput(index, value, handler, priority) end

---Lets an analog input interrupt the program when the comparison becomes true; see onDigitalInput.
---@param index integer|string number of the input, from 1, or its name
---@param comparison "<"|"<="|">"|">="|"=="|"~=" one of < <= > >= == ~=
---@param value number what the input is compared with
---@param handler fun(): "abort"|nil called at the change; it may return 'abort'
---@param priority? integer 1 is the most urgent, 100 the default
---@return integer # the interrupt's number
function onAnalogInput(index, comparison, value, handler, priority) end

---Removes an interrupt.
---@param number integer what onDigitalInput or onAnalogInput returned
function removeInterrupt(number) end

---Lets `reference_pose` guide the robot (state TRAJECTORY).
---@param time number longest time of it (s)
---@param index? integer|string number or name of a digital input that ends it
---@param value? boolean|0|1 the value of it that does
---@return boolean # true if the input ended it, false after `time`
function followReference(time, index, value) end

---Lets a person jog the robot (state TEACH).
---@param time number longest time of it (s)
---@param index? integer|string number or name of a digital input that ends it
---@param value? boolean|0|1 the value of it that does
---@return boolean # true if the input ended it, false after `time`
function jog(time, index, value) end

---Holds the program until an operator resumes it. In simulated time it continues at once.
---@param string? string why, for the operator
function halt(string) end

---Runs a program beside this one, with the same globals and further arguments as `...`. It neither moves the robot nor changes motion settings.
---@param program string file of the task, seen from the folder of the main program
---@param ... any
function startTask(program, ...) end

---Reads the joint positions, in degrees; in metres for sliding axes.
---@return number[] # a table of n numbers
function getJointAngles() end

---Reads the present joint speeds, in degrees/s, in m/s for sliding axes; does not wait.
---@return number[] # a table of n numbers
function getJointSpeeds() end

---Reads the present motor torques at the joints, in N m (N); does not wait.
---@return number[] # a table of n numbers
function getJointTorques() end

---Reads the pose of the tool in the base frame: {x, y, z, phi1, phi2, phi3}.
---@return Pose # a pose
function getCartesianPosition() end

---Stores the present position of the robot in the points file, under a name.
---@param name string name of the point
function teach(name) end

---Reads where a taught point is for the tool and base that are set: {x, y, z, phi1, phi2, phi3}.
---@param name string name of the point
---@return Pose # a pose
function getTaughtPose(name) end

---Reads a taught point: its joint angles, and the pose of the flange {x, y, z, phi1, phi2, phi3}.
---@param name string name of the point
---@return number[], Pose # a table of n numbers, a pose
function getTaughtPoint(name) end

---Makes a pose: a table with its six numbers, also as `p.x` to `p.phi3`; `a * b` is compose(a, b).
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@return Pose # a pose
---@overload fun(pose: Pose|number[])
function pose(x, y, z, phi1, phi2, phi3) end

---Chains poses: each one is relative to the one before it.
---@param ... Pose|number[] pose seen from the one before it
---@return Pose # a pose
function compose(...) end

---Inverts a pose: a pose chained with its inverse is zero.
---@param pose Pose|number[] pose of a frame
---@return Pose # a pose
function inverse(pose) end

---Shifts and turns a pose along the axes of the base or, with 'tool', along its own.
---@param pose Pose|number[] pose to start from
---@param x number displacement along x (m)
---@param y number displacement along y (m)
---@param z number displacement along z (m)
---@param phi1? number turn by orientation angle 1 (deg)
---@param phi2? number turn by orientation angle 2 (deg)
---@param phi3? number turn by orientation angle 3 (deg)
---@param frame? "base"|"tool" 'base' (default) or 'tool': whose axes are meant
---@return Pose # a pose
function offset(pose, x, y, z, phi1, phi2, phi3, frame) end

---Lays out a palette: its places row by row, layer by layer, all oriented as the first.
---@param first Pose|number[] pose at the first place
---@param row_end Pose|number[] pose at the end of the first row; its position counts
---@param columns integer places in a row
---@param column_end? Pose|number[] pose at the end of the first column
---@param rows? integer rows
---@param stack_end? Pose|number[] pose at the top of the first stack
---@param layers? integer layers
---@return Pose[] # a table of poses
function grid(first, row_end, columns, column_end, rows, stack_end, layers) end

---Computes the pose of the tool at joint angles.
---@param q1 number joint angle, in metres for a sliding axis (deg (m))
---@param q2 number joint angle, in metres for a sliding axis (deg (m))
---@param q3 number joint angle, in metres for a sliding axis (deg (m))
---@param q4 number joint angle, in metres for a sliding axis (deg (m))
---@param q5 number joint angle, in metres for a sliding axis (deg (m))
---@param q6 number joint angle, in metres for a sliding axis (deg (m))
---@return Pose # a pose
---@overload fun(q1: number, q2: number, q3: number)
---@overload fun(q1: number, q2: number, q3: number, q4: number)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number)
---@overload fun(q1: number, q2: number, q3: number, q4: number, q5: number, q6: number, q7: number)
---@overload fun(q: number[])
function forwardKinematics(q1, q2, q3, q4, q5, q6) end

---Computes the joint angles with which ptpJointSpacePosition reaches a pose. It fails if there are none.
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@param near? number[] joint angles to search from; the last target by default (deg (m))
---@return number[] # a table of n numbers
---@overload fun(pose: Pose|number[], near?: number[])
function inverseKinematics(x, y, z, phi1, phi2, phi3, near) end

---Tests whether joint angles inside the limits reach a pose.
---@param x number x of the tool in the base frame (m)
---@param y number y of the tool in the base frame (m)
---@param z number z of the tool in the base frame (m)
---@param phi1 number orientation angle 1 in the robot's convention (deg)
---@param phi2 number orientation angle 2 in the robot's convention (deg)
---@param phi3 number orientation angle 3 in the robot's convention (deg)
---@param near? number[] joint angles to search from; the last target by default (deg (m))
---@return boolean # true or false
---@overload fun(pose: Pose|number[], near?: number[])
function isReachable(x, y, z, phi1, phi2, phi3, near) end

---Switches a digital output, now or when the robot is at the last target; the program continues.
---@param index integer|string number of the output, from 1, or its name
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param moment? "now"|"arrival" 'now' (default), or 'arrival': when the robot is at the last target, also where it runs through
function setDigitalOutput(index, value, moment) end

---Reads a digital input.
---@param index integer|string number of the input, from 1, or its name
---@return boolean # true or false
function getDigitalInput(index) end

---Reads a digital output back.
---@param index integer|string number of the output, from 1, or its name
---@return boolean # true or false
function getDigitalOutput(index) end

---Sets an analog output, now or when the robot is at the last target; the program continues.
---@param index integer|string number of the output, from 1, or its name
---@param value number value of the output
---@param moment? "now"|"arrival" 'now' (default), or 'arrival': when the robot is at the last target, also where it runs through
function setAnalogOutput(index, value, moment) end

---Reads an analog input.
---@param index integer|string number of the input, from 1, or its name
---@return number # a number
function getAnalogInput(index) end

---Reads an analog output back.
---@param index integer|string number of the output, from 1, or its name
---@return number # a number
function getAnalogOutput(index) end

---Waits until a digital input has a value.
---@param index integer|string number of the input, from 1, or its name
---@param value boolean|0|1 0 or false: off, 1 or true: on
---@param timeout? number longest wait; without one it waits for ever (s)
---@return boolean # true, or false after `timeout`
function waitDigitalInput(index, value, timeout) end

---Waits until an analog input compares. As waitAnalogInput(1, '>', 2.5).
---@param index integer|string number of the input, from 1, or its name
---@param comparison "<"|"<="|">"|">="|"=="|"~=" one of < <= > >= == ~=
---@param value number what the input is compared with
---@param timeout? number longest wait; without one it waits for ever (s)
---@return boolean # true, or false after `timeout`
function waitAnalogInput(index, comparison, value, timeout) end

---Switches a digital output on, and off again after a time; the program continues meanwhile.
---@param index integer|string number of the output, from 1, or its name
---@param time number how long it is on (s)
function pulseDigitalOutput(index, time) end

---Runs another program as subprogram; it has the same globals, and further arguments as `...`.
---@param program string file of the subprogram, seen from the folder of the main program
---@param ... any
---@return ... # what the subprogram returns
function call(program, ...) end

---Reads the time since the program's start; pauses count.
---@return number # s, a number
function getTime() end

---Starts a timer. `local elapsed = timer()`, and `elapsed()` is the time since then.
---@return fun(): number # a function that returns s
function timer() end

---Waits.
---@param time number how long, not counting pauses (s)
function wait(time) end

---Writes a line to the program's output.
---@param string any any values; several are separated by tabs
function print(string) end

---Stores a value for later runs in a file beside the program. In simulated time it is stored until the run ends.
---@param name string name of the value
---@param value? number|string|boolean|number[] number, string, boolean, list of numbers; nil for none
function setPersistent(name, value) end

---Reads a stored value.
---@param name string name of the value
---@param default? number|string|boolean|number[] what is returned if there is none
---@return any # the value, or `default`
function getPersistent(name, default) end
