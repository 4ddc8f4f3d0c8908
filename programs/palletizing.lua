-- Robot: kuka_kr210_r2700
-- Palletizing: eight boxes from the end of a conveyor onto a pallet, two layers of two by two. Vacuum gripper
-- on digital output 1, 0.25 m long. All points are computed. Subprograms: palletizing/pick.lua and place.lua.
BOX = {length = 0.40, width = 0.30, height = 0.25, mass = 40} -- m, kg
APPROACH = 0.20 -- m above a box
local ROWS, COLUMNS, LAYERS, GAP = 2, 2, 2, 0.02

-- The pallet's corner, seen from the robot: x along its longer side.
local PALLET = {1.20, -1.30, 0.10, 0, 0, 0}
local CONVEYOR = {1.60, 0.60, 0.50, 0, 0, 0}

-- Middle of a box's top, seen from the pallet. The second layer is turned, so that it binds the first.
local function place_of(row, column, layer)
  local turned = layer % 2 == 0
  local dx = (turned and BOX.width or BOX.length) + GAP
  local dy = (turned and BOX.length or BOX.width) + GAP
  return (row - 0.5) * dx, (column - 0.5) * dy, layer * BOX.height, turned and 90 or 0
end

setDigitalOutput(1, 0)
setTool(0, 0, 0.25, 0, 0, 0)
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
local count = 0
for layer = 1, LAYERS do
  for column = 1, COLUMNS do
    for row = 1, ROWS do
      setBase(CONVEYOR)
      call("palletizing/pick", BOX.height)
      setBase(PALLET)
      call("palletizing/place", place_of(row, column, layer))
      count = count + 1
      print(string.format("box %d of %d: layer %d", count, ROWS * COLUMNS * LAYERS, layer))
    end
  end
end
setBase(0, 0, 0, 0, 0, 0)
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
print("pallet full")
