-- Robot: kuka_kr210_r2700  IO: ../io/language.yaml
-- Motions that a condition ends: an input, an analog input, a torque.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
setSpeed(nil, 0.1)
local start = getCartesianPosition()

-- The PLC reports a contact 1 s after the lamp.
setDigitalOutput("lamp", true)
local met, stands, contact = moveUntil({input = "contact"}, linearRelative, 0, 0, -0.3, 0, 0, 0)
assert(met and contact.z < start.z and contact.z > stands.z and stands.z > start.z - 0.12)
print(string.format("contact at z = %.3f m, %.1f mm to brake", contact.z, 1000 * (contact.z - stands.z)))
ptpCartesianSpace(start)

setDigitalOutput("lamp", false)
setAnalogOutput("valve", 2.5)
met = moveUntil({analog_input = "pressure", above = 3}, ptpCartesianSpace, offset(start, 0, 0.3, 0))
assert(met and getAnalogInput("pressure") > 3)

-- What is not met: the robot comes to its target.
met, stands = moveUntil({input = "contact"}, ptpJointSpacePosition, start)
assert(not met and math.abs(stands.y - start.y) < 1e-3)

-- A torque counts with its sign; what holds already moves nothing.
local torque = getJointTorques()[2]
met, stands = moveUntil({joint_torque = 2, above = torque - 1}, linearRelative, 0, 0, -0.1, 0, 0, 0)
assert(met and math.abs(stands.z - start.z) < 1e-3)
