# %% [markdown]
# # A detection, drawn
# The cells of this file run one by one in editors that have them (Visual Studio Code, Spyder, Jupyter with jupytext);
# as a program it writes `detection.png`.

# %% Recognise an image of the camera
import graspdb
from recognize import CAMERA, capture

image = capture()
with graspdb.Client("127.0.0.1:50051") as client:
    result = client.recognize(depth=image, intrinsics=CAMERA)
result.status

# %% Draw it: the scan by its height, name and score, the object's frame, the gripper of the best grasp
axes = result.draw()
axes.figure.savefig("detection.png")

# %% The numbers: T_world_object, and T_world_tcp of the best grasp
(box,) = result.detections
print(box.object, box.score)
print(box.pose.round(4))
print(box.grasps[0].grasp_id, box.grasps[0].gripper_opening_m)
print(box.grasps[0].tcp_pose.round(4))
