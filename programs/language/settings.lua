-- Robot: kuka_kr210_r2700
-- Planners, configurations and jerk limits, chosen by the program.
setPlanner("linear_joint_axes")
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
local place = getCartesianPosition()
local side = offset(place, 0, 0.3, 0)

-- The same place, with the elbow and then the wrist the other way round.
local up = inverseKinematics(side)
setConfiguration("front/up/flip")
local flipped = inverseKinematics(side)
assert(up[5] * flipped[5] < 0, "axis 5 bends to the other side")
setPlanner("linear_joint", "dynamic_programming")
ptpJointSpacePosition(side)
assert(getJointAngles()[5] * flipped[5] > 0)
setConfiguration()

setJerkLimited(true)
linearRelative(0, 0, -0.1, 0, 0, 0)
setJerkLimited(false)
setPlanner(nil, "limited")

-- Joint motions around obstacles; here there are none.
setAvoid(true, 2, 'replan')  -- and around an obstacle that comes into the path
ptpJointSpaceAnglesRelative(10, 0, 0, 0, 0, 0)
setAvoid(false)
linearRelative(0, 0, 0.1, 0, 0, 0)
