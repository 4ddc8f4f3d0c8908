-- Robot: kuka_kr210_r2700
-- A person jogs the robot, then a sensor guides it, each until an input or for 0.1 s.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
local jogged = jog(0.1, 1, true)
if not jogged then followReference(0.1, 2) end
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
