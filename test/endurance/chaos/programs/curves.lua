-- Robot: staubli_tx2_90  IO: feeder.yaml
-- Arcs and splines while a dispenser is open, and a feeder that is asked in between. Dispenser on digital output 1,
-- request on 2, which the feeder answers on digital input 1.
setDigitalOutput(1, 0)
setDigitalOutput(2, 0)
ptpJointSpaceAngles(10, 20, 70, 10, 60, 0)
setSpeed(1, 0.3, 60)
local start = getCartesianPosition()
while true do
  setDigitalOutput(1, 1)
  circCartesianSpace(offset(start, 0, 0.1, 0.08), offset(start, 0, 0.2, 0))
  splineCartesianSpace(offset(start, 0.06, 0.15, -0.05), offset(start, 0, 0.1, -0.08), start)
  setDigitalOutput(1, 0)
  setDigitalOutput(2, 1)
  if not waitDigitalInput(1, 1, 10) then error("the feeder does not answer") end
  setDigitalOutput(2, 0)
end
