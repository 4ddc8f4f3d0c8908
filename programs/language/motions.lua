-- Robot: kuka_kr210_r2700
-- Every kind of motion, and the speeds that hold for them.
setSpeed(1, 0.5, 60)
setAcceleration(0.8, 3)
setOverride(1)
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
local start = getCartesianPosition()
circCartesianSpace(offset(start, 0, 0.1, 0.1), offset(start, 0, 0.2, 0), {blend = 0.02})
splineCartesianSpace(offset(start, 0.1, 0.1, 0), offset(start, 0.1, 0, 0.05), start)
linearRelative(0, 0, 0.1, 0, 0, 0)
ptpJointSpaceAnglesRelative({10, 0, 0, 0, 0, 0}, {jointBlend = 3})
ptpJointSpacePosition(start)
assert(math.abs(getJointAngles()[1]) < 1e-3)
