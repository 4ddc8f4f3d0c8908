-- Robot: kuka_kr210_r2700
-- A palette from its corners: three columns, two rows, two layers.
local first = pose(1.5, -0.2, 0.9, 0, 0, 180)
local places = grid(first, offset(first, 0, 0.4, 0), 3, offset(first, 0.3, 0, 0), 2, offset(first, 0, 0, 0.2), 2)
assert(#places == 12 and places[12].z > places[1].z)

ptpJointSpacePosition(offset(first, 0, 0, 0.3))
for i, place in ipairs(places) do
  if i <= 3 then ptpCartesianSpace(place) end
end
