-- Task: counts the parts that come, and shows on an output whether one is there.
local lamp = ...
while true do
  waitDigitalInput("part_present", true)
  parts = parts + 1
  setDigitalOutput(lamp, true)
  waitDigitalInput("part_present", false)
  setDigitalOutput(lamp, false)
end
