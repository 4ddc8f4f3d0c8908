-- Robot: bello_bot
-- Carries a part across its table. Gripper: output 1, its force (N): analog output 1, part sensor: input 1.
local CLOSED, OPEN = 1, 0
local ABOVE, AT_PART = 0.42, 0.32 -- m, height of the flange

local function home()
  ptpJointSpaceAngles(0, 30, 0, 90, 0, 60, 0)
end

-- The tool points down; phi1 turns it about the vertical.
local function over(y, phi1)
  return {0.57, y, ABOVE, phi1, 0, 180}
end

local function down_and_up(y, phi1, gripper)
  ptpCartesianSpace(0.57, y, AT_PART, phi1, 0, 180)
  setDigitalOutput(1, gripper)
  wait(0.5) -- the fingers move
  ptpCartesianSpace(over(y, phi1))
end

print("Bello Bot's tour")
setDigitalOutput(1, OPEN)
setAnalogOutput(1, 20)
home()

ptpJointSpaceAngles(40, 30, 0, 90, 0, 60, 0)
down_and_up(0.48, -140, CLOSED)
if getDigitalInput(1) then
  print("part gripped")
else
  print("no part sensor: going on")
end

home()
ptpJointSpacePosition(over(-0.48, 140))
down_and_up(-0.48, 140, OPEN)

-- A look around with the elbow out: the third axis is the one that a six-axis robot lacks.
ptpJointSpaceAngles(-60, 20, 30, 100, 0, 60, 0)
home()
setAnalogOutput(1, 0)
print("done")
