-- Robot: kuka_kr210_r3100
-- Wheel test (paper, 5.2): at constant speed; wheel drive on analog output 1 (rad/s), measuring on digital 1.
local RADIUS, SPEED = 0.125, 0.05 -- m, m/s
local TRACK, RAMP = 0.80, 0.05 -- m: measured way, and the way before and after it to gain and lose speed
local X, HEIGHT, LIFT = 1.80, 0.70, 0.15 -- m: where the track is

local start, finish = -TRACK / 2 - RAMP, TRACK / 2 + RAMP

local function measure(slip)
  ptpJointSpacePosition(X, start, HEIGHT + LIFT, 90, 0, 180)
  setSpeed(nil, 0.10)
  ptpCartesianSpace(X, start, HEIGHT, 90, 0, 180) -- onto the soil
  -- Slip: the part of the wheel's way that the ground does not see.
  setAnalogOutput(1, SPEED / (1 - slip) / RADIUS)
  setSpeed(nil, SPEED)
  setAcceleration(nil, 1)
  ptpCartesianSpace({X, finish, HEIGHT, 90, 0, 180}, {on_path = {
    {distance_after_start = RAMP, output = 1, value = true},
    {distance_before_end = RAMP, output = 1, value = false},
  }})
  setAnalogOutput(1, 0)
  setSpeed(nil, 0.10)
  linearRelative(0, 0, LIFT, 0, 0, 0)
  print(string.format("slip %.0f %%: %.2f m at %.2f m/s", 100 * slip, TRACK, SPEED))
end

ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
setDigitalOutput(1, 0)
for _, slip in ipairs {0, 0.2} do measure(slip) end
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
