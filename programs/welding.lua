-- Robot: kuka_kr210_r2700
-- Welding, the example of the paper's section 4.4 as far as it is printed. Welding gun on digital output 1.
print("Welding Program 1")
setDigitalOutput(1, 0) -- deactivate welding gun
wait(1)
ptpJointSpaceAngles(0, -90, 45, 0, 45, 0)
ptpCartesianSpace(0.37, -1.78, 1.21, -42.03, 117.47, -35.89)
ptpCartesianSpace(0.37, -1.78, 1.18, -42.03, 117.47, -35.89)
setDigitalOutput(1, 1) -- activate welding gun
wait(1) -- wait for completion of welding process
setDigitalOutput(1, 0) -- deactivate welding gun
ptpCartesianSpace(0.375, -1.78, 1.21, -42.03, 117.47, -35.89)
