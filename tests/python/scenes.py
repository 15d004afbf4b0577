"""Depth images of shapes of boxes on a table, as a camera without noise takes them."""
import math

import numpy as np

import graspdb

WIDTH, HEIGHT = 320, 240
CAMERA = graspdb.Intrinsics(fx=300, fy=300, cx=159.5, cy=119.5)
EYE = np.array([0, -0.45, 0.54])

# Boxes as centre and half size, in the frame of the object: z up, the table at 0.
BRACKET = [((0, 0, 0.006), (0.045, 0.03, 0.006)), ((-0.039, 0, 0.03), (0.006, 0.03, 0.03)),
           ((0.02, 0.02, 0.02), (0.012, 0.01, 0.02))]
TOWER = [((0, 0, 0.05), (0.02, 0.02, 0.05)), ((0, 0, 0.11), (0.04, 0.008, 0.01))]


def pose(x=0.0, y=0.0, yaw_deg=0.0):
    """T_world_object of an object on the table."""
    yaw = math.radians(yaw_deg)
    return np.array([[math.cos(yaw), -math.sin(yaw), 0, x], [math.sin(yaw), math.cos(yaw), 0, y], [0, 0, 1, 0],
                     [0, 0, 0, 1]])


def sensor_pose():
    """T_world_sensor: looks from EYE at the origin."""
    z = -EYE / np.linalg.norm(EYE)
    x = np.array([1.0, 0, 0])
    out = np.eye(4)
    out[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    out[:3, 3] = EYE
    return out


def depth(shape, object_pose):
    """Millimetres as uint16, of the shape on the table; of the table alone without a shape."""
    v, u = np.indices((HEIGHT, WIDTH))
    rays = np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones((HEIGHT, WIDTH))], axis=-1)
    rays = rays @ sensor_pose()[:3, :3].T
    with np.errstate(divide="ignore"):
        z = np.where(rays[..., 2] < 0, -EYE[2] / rays[..., 2], np.inf)
    eye = object_pose[:3, :3].T @ (EYE - object_pose[:3, 3])
    rays = rays @ object_pose[:3, :3]
    for centre, half in shape or ():
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([(centre + sign * np.array(half) - eye) / rays for sign in (-1, 1)])
        near, far = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
        z = np.where((near < far) & (near > 0), np.minimum(z, near), z)
    return np.where(z < 60, np.rint(1000 * z), 0).astype(np.uint16)


def points(image):
    """H × W × 3 points of an image in metres, NaN without a measurement."""
    v, u = np.indices(image.shape)
    z = np.where(image > 0, image / 1000, np.nan)
    return np.stack([(u - CAMERA.cx) / CAMERA.fx * z, (v - CAMERA.cy) / CAMERA.fy * z, z], axis=-1)


def views(stable_pose, shape, step_deg=30):
    """Views of the shape from all sides."""
    return [graspdb.View(stable_pose, depth=depth(shape, pose(yaw_deg=yaw)), intrinsics=CAMERA,
                         object_pose=pose(yaw_deg=yaw), sensor_pose=sensor_pose())
            for yaw in range(0, 360, step_deg)]
