-- Robot: kuka_kr210_r2700
-- Laser welding of a wavy seam, sent as many short lines that run through. Laser on digital output 1, on along the seam.
local LINES, STEP = 70, 0.005 -- m
local SPEED, ZONE = 0.1, 0.001 -- m/s, m
local WAVE, LENGTH = 0.01, 0.12 -- m: height and length of a wave

local function seam(x)
  return WAVE * math.sin(2 * math.pi * x / LENGTH)
end

ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
setSpeed(nil, SPEED)
local y = 0
for i = 1, LINES do
  local options = {blend = ZONE}
  if i == 1 then options.on_path = {distance_after_start = 0.002, output = 1, value = true} end
  if i == LINES then options = {on_path = {distance_before_end = 0.002, output = 1, value = false}} end
  local to = seam(i * STEP)
  linearRelative(STEP, to - y, 0, 0, 0, 0, options)
  y = to
end
