-- Robot: kuka_kr210_r2700  IO: io/press_tending.yaml
-- Tends a press whose signals come from a PLC; the file above plays it and says which signal means what.
local PRESS_READY, PRESS_CLOSED, PART_PRESENT, PART_PRESSED = 1, 2, 3, 4 -- digital inputs
local START_PRESS, GRIPPER, PART_PLACED = 1, 2, 3 -- digital outputs
local PARTS, PATIENCE = 2, 10 -- parts, s

local FEEDER = {0.30, 1.60, 0.70, 90, 0, 180}
local PRESS = {1.90, 0, 1.00, 0, 0, 180}
local TRAY = {0.30, -1.60, 0.70, -90, 0, 180}

local function above(place, height)
  return {place[1], place[2], place[3] + height, place[4], place[5], place[6]}
end

local function need(input, value, what)
  if not waitDigitalInput(input, value, PATIENCE) then
    error(what .. " does not come within " .. PATIENCE .. " s")
  end
end

-- Down to a place, gripper closed or open, and up again.
local function grip(place, closed)
  ptpCartesianSpace(place)
  setDigitalOutput(GRIPPER, closed)
  wait(0.3) -- the fingers move
  ptpCartesianSpace(above(place, 0.25))
end

local function outside()
  ptpJointSpaceAngles(0, -100, 110, 0, 80, 0)
end

for _, output in ipairs {START_PRESS, GRIPPER, PART_PLACED} do setDigitalOutput(output, false) end
for part = 1, PARTS do
  ptpJointSpacePosition(above(FEEDER, 0.25))
  need(PART_PRESENT, true, "a part")
  grip(FEEDER, true)

  outside()
  need(PRESS_READY, true, "the press")
  ptpJointSpacePosition(above(PRESS, 0.25))
  grip(PRESS, false)
  outside()

  setDigitalOutput(START_PRESS, true)
  need(PRESS_CLOSED, true, "the stroke")
  setDigitalOutput(START_PRESS, false)
  print(string.format("part %d: %.0f kN", part, getAnalogInput(1)))
  need(PART_PRESSED, true, "the pressed part")

  ptpJointSpacePosition(above(PRESS, 0.25))
  grip(PRESS, true)
  outside()
  ptpJointSpacePosition(above(TRAY, 0.25))
  grip(TRAY, false)
  pulseDigitalOutput(PART_PLACED, 0.3)
end
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
print(PARTS .. " parts pressed")
