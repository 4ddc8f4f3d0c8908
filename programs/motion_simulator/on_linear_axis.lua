-- Robot: kuka_kr500_linear_axis  Cabin: cabin_on_axis.yaml  References: double_lane_change
-- Motion simulator on a linear axis: one axis more, by which the cabin moves farther forward and back.
local MIDDLE = {1.60, 0, 1.60, 180, 0, 180} -- of the flange, which holds the cabin by its roof
local TIME = 26 -- s, a little longer than the recording

setPayload(300, 0, 0, 0.7) -- kg and m: the cabin with a person
ptpJointSpacePosition(MIDDLE)
print("a person drives")
followReference(TIME)
print("the cabin stands")
ptpJointSpacePosition(MIDDLE)
