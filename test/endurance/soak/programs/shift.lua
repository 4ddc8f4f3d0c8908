-- Robot: kuka_kr210_r2700  Scene: ../../chaos/programs/column.yaml
-- Half a minute of work: lines, blends, joint motions, outputs, and a PLC that is asked for each part.
local REQUEST, GRIPPER, READY, ROUNDS = 2, 1, 1, 4
setTool(0, 0, 0.2, 0, 0, 0)
ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)
local start = getCartesianPosition()
for round = 1, ROUNDS do
  setDigitalOutput(REQUEST, 1)
  if not waitDigitalInput(READY, 1, 10) then error("the PLC does not answer") end
  setDigitalOutput(REQUEST, 0)
  ptpCartesianSpace(offset(start, 0, -0.4, 0), {blend = 0.05})
  ptpCartesianSpace(offset(start, 0.1, -0.4, -0.3))
  setDigitalOutput(GRIPPER, 1)
  setAnalogOutput(1, round)
  ptpCartesianSpace(offset(start, 0.1, 0.4, -0.3), {on_path = {{distance_before_end = 0.2, output = 3, value = 1}}})
  setDigitalOutput(3, 0)
  circCartesianSpace(offset(start, 0.05, 0.4, -0.1), offset(start, 0, 0.3, 0))
  setDigitalOutput(GRIPPER, 0)
  ptpJointSpaceAngles({20, -95, 95, 0, 60, 0}, {jointBlend = 5})
  ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)
  print(string.format("round %d of %d", round, ROUNDS))
end
