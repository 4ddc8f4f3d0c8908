-- Robot: kuka_kr210_r2700  IO: ../io/language.yaml
-- Handlers of inputs: digital, analog, by priority, taken away; outputs at a place that the robot runs through.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
local log = {}
local guard = onDigitalInput("part_present", true, function()
  log[#log + 1] = "part"
  setAnalogOutput("valve", 2.5)
  wait(0.5) -- the pressure comes meanwhile, and is more urgent
  log[#log + 1] = "part done"
end, 20)
onAnalogInput("pressure", ">", 3, function() log[#log + 1] = "pressure" end, 1)

setDigitalOutput("gripper", true)
linearRelative(0, 0, -0.3, 0, 0, 0)
assert(table.concat(log, ", ") == "part, pressure, part done", table.concat(log, ", "))

removeInterrupt(guard)
setDigitalOutput("gripper", false)
wait(0.1)
setDigitalOutput("gripper", true)
linearRelative(0, 0, 0.3, 0, 0, 0)
assert(#log == 3)

-- The lamp is switched at the corner, although the robot runs through it.
linearRelative(0, 0.2, 0, 0, 0, 0, {blend = 0.03})
setDigitalOutput("lamp", true, "arrival")
assert(not getDigitalOutput("lamp"))
linearRelative(0, 0, -0.2, 0, 0, 0)
assert(getDigitalOutput("lamp"))
