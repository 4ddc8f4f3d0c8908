-- Robot: kuka_kr500_r2830  Cabin: motion_simulator/cabin.yaml  References: motion_simulator/double_lane_change
-- Motion simulator (paper, 5.1): the robot moves a cabin so that a person in it feels the car of the recording.
local MIDDLE = {1.60, 0, 1.60, 180, 0, 180} -- of the flange, which holds the cabin by its roof
local TIME = 26 -- s, a little longer than the recording

setPayload(300, 0, 0, 0.7) -- kg and m: the cabin with a person
ptpJointSpacePosition(MIDDLE)
print("a person drives")
followReference(TIME)
print("the cabin stands")
ptpJointSpacePosition(MIDDLE)
