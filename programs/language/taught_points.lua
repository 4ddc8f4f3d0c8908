-- Robot: kuka_kr210_r2700
-- Points that are taught, and the torques that hold the robot there.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
teach("home")
for _, torque in ipairs(getJointTorques()) do assert(torque == torque) end
ptpJointSpaceAnglesRelative(5, 0, 0, 0, 0, 0)
local joints, flange = getTaughtPoint("home")
assert(#joints == 6 and math.abs(flange.y) < 1e-3)
ptpJointSpaceAngles(joints)
-- Where the point is for the tool that is set.
setTool(0, 0, 0.2, 0, 0, 0)
local tip = getTaughtPose("home")
assert(math.abs((flange * { 0, 0, 0.2, 0, 0, 0 }).x - tip.x) < 1e-9)
