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

local function over_deck() ptpJointSpaceAngles(0.274, 4.8, 226.1, 79.7, -10, 39, -44.2) end
local function over_ground() ptpJointSpaceAngles(0.177, -120.1, 272.9, 102.2, -177.3, -10.7, 123.9) end

hand(false)
over_deck()
print("mast and arm over the deck")
setSpeed(nil, 0.1, 20)
linearRelative(0, 0, -DOWN, 0, 0, 0)
hand(true)
linearRelative(0, 0, DOWN, 0, 0, 0)
print("package lifted")

setSpeed(0.5) -- it swings with the rover's springs
over_ground()
linearRelative(0, 0, -DOWN, 0, 0, 0)
local place = getCartesianPosition()
hand(false)
print(string.format("package placed at (%.2f, %.2f) m", place[1], place[2]))
linearRelative(0, 0, DOWN, 0, 0, 0)
ptpJointSpaceAngles(0.2, -84.5, 167.4, 57.6, -119.5, 82.9, 75.5)
