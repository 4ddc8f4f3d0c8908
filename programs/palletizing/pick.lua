-- Subprogram of palletizing.lua: takes a box whose top is at height z of the base.
-- The robot runs through above the conveyor: on its way there it cuts the corners.
local z = ...
ptpJointSpacePosition({0, 0, z + APPROACH, 0, 0, 180}, {jointBlend = 5})
ptpCartesianSpace(0, 0, z, 0, 0, 180)
setDigitalOutput(1, 1)
wait(0.3) -- the vacuum builds up
setPayload(BOX.mass, 0, 0, 0.25 + BOX.height / 2)
linearRelative({0, 0, APPROACH, 0, 0, 0}, {blend = 0.10})
