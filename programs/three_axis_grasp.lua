-- Robot: debris_arm?gravity=0,0,0
-- Active debris removal after the paper's section 5.3: an arm on a satellite grasps the docking ring of a
-- target that still drifts. Gripper on digital output 1; digital input 1 tells contact, if somebody does.
local SHOULDER, UPPER_ARM, FOREARM = 1.15, 1.70, 1.60 -- m

-- Three axes reach a position, not a pose: joint angles in degrees from the geometry of two links.
local function reach(x, y, z)
  local across, up = math.sqrt(x * x + y * y), z - SHOULDER
  local far = across * across + up * up
  local c = (far - UPPER_ARM ^ 2 - FOREARM ^ 2) / (2 * UPPER_ARM * FOREARM)
  if c < -1 or c > 1 then
    error(string.format("(%.2f, %.2f, %.2f) m is out of reach: %.2f m from the shoulder", x, y, z, far ^ 0.5))
  end
  local elbow = math.acos(c)
  local shoulder = math.atan(across, up) - math.atan(FOREARM * math.sin(elbow), UPPER_ARM + FOREARM * c)
  return {math.deg(math.atan(y, x)), math.deg(shoulder), math.deg(elbow)}
end

-- The docking ring drifts at constant speed, as the chaser sees it.
local RING, DRIFT = {2.30, 0.60, 1.90}, {-0.004, -0.012, 0.003} -- m, m/s
local function ring_at(time, distance)
  return reach(RING[1] + DRIFT[1] * time - distance, RING[2] + DRIFT[2] * time, RING[3] + DRIFT[3] * time)
end

setDigitalOutput(1, 0)
ptpJointSpaceAngles(0, 0, 120) -- folded
local STEP = 0.7 -- s, what one step takes at this speed
setSpeed(0.5)
ptpJointSpaceAngles(ring_at(10, 0.40)) -- wait before the ring
print("synchronized")

-- The last 0.4 m in small steps, each to where the ring will be; contact ends the approach at once.
local contact = false
onDigitalInput(1, true, function()
  contact = true
  return "abort"
end)
for step = 1, 8 do
  if contact then break end
  ptpJointSpaceAngles(ring_at(10 + STEP * step, 0.40 * (1 - step / 8)))
end
setDigitalOutput(1, 1) -- grasp
wait(1)
print(contact and "contact: ring grasped" or "ring grasped")

-- Pull it in: what turns now turns with both.
setSpeed(0.3)
ptpJointSpaceAnglesRelative(0, -15, 30)
print("connected")
