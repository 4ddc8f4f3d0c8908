-- Subprogram: turns the base with a part in the gripper; returns by how much.
local angle = ...
setDigitalOutput("gripper", true)
ptpJointSpaceAnglesRelative(angle, 0, 0, 0, 0, 0)
assert(getDigitalOutput("lamp") and getAnalogOutput("valve") == 1)
setDigitalOutput("gripper", false)
wait(0.1)
return angle
