-- Robot: kuka_kr210_r2700  IO: ../io/language.yaml
-- Programs beside this one, a subprogram with arguments, and a counter that is kept over runs.
parts = getPersistent("parts", 0) -- a global: tasks have the same ones
local before = parts
startTask("tasks/watch", "lamp")
startTask("tasks/mirror")

ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
for _, angle in ipairs {10, -10} do
  local moved = call("tasks/fetch", angle)
  assert(moved == angle and getAnalogOutput("valve") == 0)
end
assert(parts == before + 2 and not getDigitalOutput("lamp"))
setPersistent("parts", parts)
assert(getPersistent("parts") == parts)
