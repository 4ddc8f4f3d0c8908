-- Robot: kuka_kr500_r2830  Cabin: cabin.yaml
-- Motion simulator with a person who drives, by a joystick (topic joy), until input 1 is on.
local MIDDLE = {1.60, 0, 1.60, 180, 0, 180} -- of the flange, which holds the cabin by its roof
local LONGEST = 3600 -- s

setPayload(300, 0, 0, 0.7) -- kg and m: the cabin with a person
ptpJointSpacePosition(MIDDLE)
print("the person drives")
followReference(LONGEST, 1)
ptpJointSpacePosition(MIDDLE)
