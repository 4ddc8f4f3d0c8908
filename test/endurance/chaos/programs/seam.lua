-- Robot: kuka_kr210_r2700  Scene: column.yaml
-- Lines around a column with the gun on along two of them. Gun on digital output 1.
setDigitalOutput(1, 0)
ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)
setSpeed(1, 0.6, 60)
local start = getCartesianPosition()
while true do
  ptpCartesianSpace(offset(start, 0, -0.6, 0))
  setDigitalOutput(1, 1)
  ptpCartesianSpace(offset(start, 0.15, -0.6, -0.5))
  ptpCartesianSpace(offset(start, 0.15, 0.6, -0.5), {on_path = {{distance_before_end = 0.1, output = 1, value = 0}}})
  ptpCartesianSpace(offset(start, 0, 0.6, 0))
  ptpCartesianSpace(start)
end
