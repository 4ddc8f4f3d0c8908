-- Robot: ur5e  Scene: place_scene.yaml
-- Places parts on the table, from which the other robot (remove.lua) takes them.
for part = 1, 2 do
    ptpJointSpaceAngles(0, -90, 90, -90, -90, 0) -- aside
    ptpJointSpaceAngles(90, -70, 100, -120, -90, 0) -- over the table
    linearRelative(0, 0, -0.1, 0, 0, 0)
    linearRelative(0, 0, 0.1, 0, 0, 0)
    ptpJointSpaceAngles(0, -90, 90, -90, -90, 0) -- aside
    setDigitalOutput("placed", true, "arrival")
    waitDigitalInput("removed", true)
    setDigitalOutput("placed", false)
    waitDigitalInput("removed", false)
    print("part " .. part .. " was removed after " .. math.floor(getTime()) .. " s")
end
