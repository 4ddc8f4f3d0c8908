-- Robot: ur5e  Scene: remove_scene.yaml
-- Removes the parts that the other robot (place.lua) places on the table.
for part = 1, 2 do
    ptpJointSpaceAngles(0, -90, 90, -90, -90, 0) -- aside
    waitDigitalInput("placed", true)
    ptpJointSpaceAngles(90, -70, 100, -120, -90, 0) -- over the table
    linearRelative(0, 0, -0.1, 0, 0, 0)
    linearRelative(0, 0, 0.1, 0, 0, 0)
    ptpJointSpaceAngles(0, -90, 90, -90, -90, 0) -- aside
    setDigitalOutput("removed", true, "arrival")
    waitDigitalInput("placed", false)
    setDigitalOutput("removed", false)
end
