-- Robot: debris_arm?gravity=0,0,0  Orbit: debris_removal/orbit.yaml
-- Active debris removal (paper, 5.3): the arm of a chaser grasps the docking ring of a tumbling target.
-- Output 1 closes the gripper at the ring. Inputs: 1 it holds the ring, 2 it does not, 3 both stand still.
local HELD, REFUSED, AT_REST = 1, 2, 3
local PATIENCE, STEADYING = 60, 120 -- s

local function relative_speed()
  return string.format("%.1f mm/s and %.2f degrees/s", 1000 * getAnalogInput(1), math.deg(getAnalogInput(2)))
end

local function check_grasp()
  if getDigitalInput(REFUSED) then
    error("grasp refused at " .. relative_speed())
  end
end

onDigitalInput(REFUSED, true, function() return "abort" end)
setSpeed(0.5)
ptpJointSpaceAngles(6, 28, 90) -- before the target
setDigitalOutput(1, 1)
wait(0.1)
check_grasp() -- what tumbles too fast is not approached
print("approaching, the target at " .. relative_speed())
local grasped = followReference(PATIENCE, HELD)
check_grasp()
if not grasped then
  error(string.format("the ring was not reached within %d s", PATIENCE))
end
print("ring grasped at " .. relative_speed())
if not waitDigitalInput(AT_REST, 1, STEADYING) then
  error(string.format("both still move after %d s", STEADYING))
end
print("chaser and target stand still")
