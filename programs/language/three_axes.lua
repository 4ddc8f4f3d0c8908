-- Robot: debris_arm
-- An arm of three axes holds positions: lines, arcs and chains of its tool, in the orientation that it has there.
ptpJointSpaceAngles(0, 0, 120)
ptpCartesianSpace(2.3, 0.4, 1.9, 0, 0, 0)
setHold("position") -- as this arm does anyway; arms of four and five axes hold directions too
ptpCartesianSpace(2.3, 0.2, 1.7, 0, 0, 0, {blend = 0.05})
circCartesianSpace({2.2, 0, 1.7, 0, 0, 0}, {2.3, -0.2, 1.7, 0, 0, 0})
local place = getCartesianPosition()
assert(math.abs(place[1] - 2.3) < 1e-3 and math.abs(place[2] + 0.2) < 1e-3 and math.abs(place[3] - 1.7) < 1e-3)

-- A whole pose needs six axes.
setHold("pose")
place[4] = place[4] + 20
local reached, reason = pcall(ptpCartesianSpace, place)
assert(not reached and reason:find("cannot turn its tool", 1, true), reason)
