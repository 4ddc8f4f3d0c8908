-- Robot: ur5e
-- Joint motions and lines that blend, with the vacuum on between two places. Vacuum on digital output 1, lamp on 3.
setDigitalOutput(3, 1)
ptpJointSpaceAngles(10, -80, 90, -70, -80, 15)
local start = getCartesianPosition()
while true do
  setDigitalOutput(1, 1)
  ptpCartesianSpace(offset(start, 0, 0, 0.12), {blend = 0.03})
  ptpCartesianSpace(offset(start, 0.1, 0.12, 0.12), {blend = 0.03})
  ptpCartesianSpace(offset(start, 0.1, 0.12, 0))
  setDigitalOutput(1, 0)
  ptpJointSpaceAngles({40, -95, 95, -70, -80, 15}, {jointBlend = 8})
  ptpJointSpaceAngles(10, -80, 90, -70, -80, 15)
end
