-- Robot: debris_arm?gravity=0,0,0
-- An arm with three axes holds positions: of the orientation its tool has what the axes leave.
setHold("position")
ptpJointSpaceAngles(0, 30, 60)
local start = getCartesianPosition()
setSpeed(nil, 0.2)
ptpCartesianSpace(offset(start, 0, 0.3, 0.1))
local there = getCartesianPosition()
assert(math.abs(there.y - start.y - 0.3) < 1e-3 and math.abs(there.z - start.z - 0.1) < 1e-3)
