-- Subprogram of palletizing.lua: puts a box down with the middle of its top at x, y, z, turned by phi.
local x, y, z, phi = ...
ptpJointSpacePosition({x, y, z + APPROACH, phi, 0, 180}, {jointBlend = 5})
setSpeed(nil, 0.25) -- gently
ptpCartesianSpace(x, y, z, phi, 0, 180)
setDigitalOutput(1, 0)
wait(0.2) -- the vacuum breaks
setPayload(0)
setSpeed(nil, 0.5)
linearRelative({0, 0, APPROACH, 0, 0, 0}, {blend = 0.10})
