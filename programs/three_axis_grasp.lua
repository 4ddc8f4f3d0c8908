-- Robot: debris_arm?gravity=0,0,0
-- Active debris removal after the paper's section 5.3: an arm on a satellite grasps the docking ring of a
-- target that still drifts. Gripper on digital output 1; digital input 1 reports contact, where something sets it.
setHold("position") -- all that three axes can hold: the orientation is the arm's

-- The docking ring drifts at constant speed, as the chaser sees it.
local RING, DRIFT = {2.30, 0.60, 1.90}, {-0.004, -0.012, 0.003} -- m, m/s
local function ring_at(time, distance)
  return {RING[1] + DRIFT[1] * time - distance, RING[2] + DRIFT[2] * time, RING[3] + DRIFT[3] * time, 0, 0, 0}
end

setDigitalOutput(1, 0)
ptpJointSpaceAngles(0, 0, 120) -- folded
local STEP = 0.53 -- s, what one step takes at this speed
setSpeed(0.5)
ptpJointSpacePosition(ring_at(10, 0.40)) -- wait before the ring
print("synchronized")

-- The last 0.4 m in small steps, each on a line to where the ring will be; contact ends the approach at once.
local contact = false
onDigitalInput(1, true, function()
  contact = true
  return "abort"
end)
for step = 1, 8 do
  if contact then break end
  ptpCartesianSpace(ring_at(10 + STEP * step, 0.40 * (1 - step / 8)))
end
setDigitalOutput(1, 1) -- grasp
wait(1)
print(contact and "contact: ring grasped" or "ring grasped")

-- Pull it in: what turns now turns with both.
setSpeed(0.3)
ptpJointSpaceAnglesRelative(0, -15, 30)
print("connected")
