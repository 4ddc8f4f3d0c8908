-- Robot: kuka_kr210_r3100  Contact: wheel_laboratory/regolith_simulant.yaml
-- Wheel laboratory (paper, 5.2): presses a wheel onto soil and drives it, once for each slip of its drive.
local LOAD, SPEED = 64.68, 0.03 -- N, m/s
local SLIPS = {0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8}
local PRESSING, DRIVING = 3.5, 7 -- s
local X, Y, SURFACE = 1.80, -0.15, 0.60 -- m: where each run begins
local NEAR, ABOVE = 0.02, 0.10 -- m: over the soil

local function over(height, y)
  return {X, y, SURFACE + height, 90, 0, 180}
end

local function command(load, speed, slip)
  setAnalogOutput(1, load)
  setAnalogOutput(2, speed)
  setAnalogOutput(3, slip)
end

local function measure(slip)
  ptpJointSpacePosition(over(ABOVE, Y))
  ptpCartesianSpace(over(NEAR, Y))
  command(LOAD, 0, slip)
  followReference(PRESSING)
  command(LOAD, SPEED, slip)
  setDigitalOutput(1, 1) -- measuring
  followReference(DRIVING)
  setDigitalOutput(1, 0)
  command(0, 0, 0)
  setSpeed(nil, 0.1)
  linearRelative(0, 0, ABOVE, 0, 0, 0)
  setSpeed()
  print(string.format("slip %.0f %%: %.2f m", 100 * slip, SPEED * DRIVING))
end

setTool(0, 0, 0.39, 0, 0, 0) -- m: the lowest point of the wheel
setPayload(15, 0, 0, 0.2) -- kg and m: the wheel with its drive and sensor
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
for _, slip in ipairs(SLIPS) do measure(slip) end
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
