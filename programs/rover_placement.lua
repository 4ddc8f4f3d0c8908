-- Robot: rover_jaco  Scene: scenes/rover_placement.yaml  IO: io/rover_placement.yaml
-- Rover mission (paper, 5.4): the mast lifts the arm, which takes a sensor package from the deck and puts it on the ground.
-- Output 1 closes the hand; input 1: it holds the package. Joint 1 is the mast, in m.
local PACKAGE = {1.4, 0, 0, 0.09} -- kg, and m in the hand
local DOWN, PATIENCE = 0.15, 3 -- m, s

local function hand(closed)
  setDigitalOutput(1, closed)
  if not waitDigitalInput(1, closed, PATIENCE) then
    error(string.format("the hand reports no %s within %d s", closed and "package" or "release", PATIENCE))
  end
  if closed then
    setPayload(table.unpack(PACKAGE))
  else
    setPayload(0)
  end
end

hand(false)
ptpJointSpaceAngles(0.38, -84.5, 167.4, 57.6, -119.5, 82.9, 75.5)
print("mast up")
ptpJointSpaceAngles(0.30, 5, 222, 80, -13, 45, 66) -- over the deck
local before = getCartesianPosition()
print(string.format("%.2f %.2f %.2f", before[1], before[2], before[3]))
