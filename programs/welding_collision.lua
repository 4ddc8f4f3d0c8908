-- Robot: kuka_kr210_r2700  Scene: scenes/car_frame.yaml
-- Spots on both sides of a car's B pillar, welded through its doors. The way from the first one to the second
-- leads through the pillar: the motion is refused. Its corrected twin is welding_around_pillar.lua.
print("Welding a car frame")
ptpJointSpacePosition(1.30, -0.55, 1.70, 0, 115, 0) -- away from the roof
ptpJointSpacePosition(1.60, -0.55, 1.30, 0, 115, 0) -- before the front door
ptpCartesianSpace(1.85, -0.55, 1.25, 0, 115, 0) -- in through the front door
setDigitalOutput(1, 1) -- activate welding gun
wait(0.2)
setDigitalOutput(1, 0) -- deactivate welding gun
ptpCartesianSpace(1.85, 0.55, 1.25, 0, 115, 0) -- to the rear door, across the B pillar
