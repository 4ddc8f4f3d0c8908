-- Robot: kuka_kr210_r2700
-- Poses, kinematics, and what holds: tool, base, payload, speeds.
local function near(a, b, tolerance)
  for _, difference in ipairs(inverse(a) * b) do
    assert(math.abs(difference) < (tolerance or 1e-6), tostring(a) .. " is not " .. tostring(b))
  end
end

setOrientationConvention("zyx")
setPayload(80, 0, 0, 0.2)
assert(getPayload()[1] == 80 and getPayload()[4] == 0.2)
setTool(0, 0, 0.25, 0, 0, 0)
setBase(1.6, 0, 0.5, 90, 0, 0)
near(getTool(), {0, 0, 0.25, 0, 0, 0})
near(getBase(), {1.6, 0, 0.5, 90, 0, 0})

-- A box on the table, seen from the base, and the grip on it, seen from the box.
local box = pose(0.2, 0, 0.3, 30, 0, 180)
local grip = pose(0, 0, -0.05, 45, 0, 0)
local place = box * grip
near(inverse(box) * place, grip)
near(place, compose(box, grip))
near(place, offset(box, 0, 0, -0.05, 45, 0, 0, "tool"))
local above = offset(place, 0, 0, 0.15)
assert(above.z > place.z and above.x == place.x)

-- The robot goes where its kinematics lead.
assert(isReachable(above) and not isReachable(offset(above, 9, 0, 0)))
local joints = inverseKinematics(above)
near(forwardKinematics(joints), above)
ptpJointSpacePosition(above, {jointBlend = 5})
assert(#getJointSpeeds() == 6) -- now, while the robot is on its way
ptpCartesianSpace(place)
near(getCartesianPosition(), place, 1e-3)
for _, speed in ipairs(getJointSpeeds()) do assert(math.abs(speed) < 1e-3) end
