-- Robot: kinova_j2n6s300
-- Rover mission after the paper's section 5.4: takes a sensor package from a rack and puts it on the ground.
-- Hand on digital output 1. All lines are relative: the way counts, however the arm stands on its rover.
local LIFT = 0.10 -- m

local function hand(closed)
  setDigitalOutput(1, closed)
  wait(1) -- three fingers move
end

local function over_rack() ptpJointSpaceAngles(-40, 200, 90, -120, 83, 75) end
local function over_ground() ptpJointSpaceAngles(-130, 220, 110, -120, 83, 75) end

hand(false)
over_rack()
setSpeed(nil, 0.05, 20)
linearRelative(0, 0, -LIFT, 0, 0, 0)
hand(true)
linearRelative(0, 0, LIFT, 0, 0, 0)
local rack = getCartesianPosition()
print(string.format("package lifted at (%.2f, %.2f, %.2f) m", rack[1], rack[2], rack[3]))

setSpeed(0.5) -- it swings with the rover's springs
over_ground()
linearRelative(0, 0, -LIFT, 0, 0, 0)
hand(false)
linearRelative(0, 0, LIFT, 0, 0, 0)
print("package placed")
ptpJointSpaceAngles(-84.5, 167.4, 57.6, -119.5, 82.9, 75.5)
