-- Robot: kuka_kr210_r2700
-- A live cell holds here until an operator lets the program go on (~/resume); simulated time goes on at once.
ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
halt("insert the next pallet")
ptpJointSpaceAngles(10, -90, 90, 0, 45, 0)
