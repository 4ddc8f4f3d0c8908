-- Robot: kuka_kr210_r2700  IO: ../io/language.yaml
-- Inputs and outputs by name and number, outputs read back, and time.
local elapsed = timer()
setDigitalOutput("gripper", true)
assert(getDigitalOutput(1) and getDigitalOutput("gripper"), "an output reads back as it was set")
assert(waitDigitalInput("part_present", true, 1), "the part")
assert(elapsed() > 0.29 and elapsed() <= getTime(), "the PLC answers after 0.3 s")

setAnalogOutput("valve", 2.5)
assert(getAnalogOutput("valve") == 2.5)
assert(waitAnalogInput("pressure", ">", 3, 1), "the pressure")
print(string.format("pressure %.1f bar", getAnalogInput(1)))

-- The output of a place on the path has a name too.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
linearRelative(0, 0, -0.1, 0, 0, 0, {on_path = {distance_before_end = 0.05, output = "lamp", value = true}})
assert(getDigitalOutput("lamp"), "the lamp is on")
setDigitalOutput("gripper", false)
assert(waitDigitalInput("part_present", false, 1))
assert(not getDigitalInput("part_present"))
