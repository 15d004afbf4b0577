"""A result as the sensor sees it, in directions x / z and y / z of the sensor's frame."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from graspdb.geometry import FloatArray

if TYPE_CHECKING:
    from graspdb.results import Detection, GraspProposal, Result

_AXIS_M = 0.04  # length of the axes of a frame
_MARGIN = 0.15  # around the detections, as a direction
_WIDTH_POINTS = 450  # of the axes on paper
_MOST_POINTS = 100_000  # more only take time


def draw(result: "Result", axes: Any = None) -> Any:
    from matplotlib import pyplot

    if axes is None:
        axes = pyplot.subplots(figsize=(9, 7), layout="constrained")[1]
    t_sensor_world = np.linalg.inv(result.sensor_pose)
    _draw_scan(axes, result, t_sensor_world)
    for detection in result.detections:
        _draw_detection(axes, t_sensor_world, detection)
    axes.set_aspect("equal")
    if not axes.yaxis_inverted():
        axes.invert_yaxis()  # y is down
    axes.set(xlabel="x / z", ylabel="y / z", title=f"{result.status.name}, revision {result.catalog_revision}")
    return axes


def _draw_scan(axes: Any, result: "Result", t_sensor_world: FloatArray) -> None:
    """The points around the detections, or all of them, by their height above the table."""
    points = result.points.reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1) & (points[:, 2] > 0)]
    if result.detections:
        seen = _seen(t_sensor_world, np.array([_place(detection) for detection in result.detections]))
        directions = _directions(points)
        near = ((directions > seen.min(axis=1, keepdims=True) - _MARGIN)
                & (directions < seen.max(axis=1, keepdims=True) + _MARGIN))
        points = points[near.all(axis=0)]
    points = points[:: len(points) // _MOST_POINTS + 1]
    if len(points) == 0:
        return
    heights = points @ result.sensor_pose[2, :3] + result.sensor_pose[2, 3]
    size = (1.2 * _WIDTH_POINTS) ** 2 / len(points)  # without gaps
    low, high = np.percentile(heights, [1, 99.9])
    dots = axes.scatter(*_directions(points), c=heights, s=size, marker="s", cmap="gray", linewidths=0, vmin=low, vmax=high)
    axes.figure.colorbar(dots, ax=axes, label="height (m)", shrink=0.7)


def _draw_detection(axes: Any, t_sensor_world: FloatArray, detection: "Detection") -> None:
    name = detection.object.rpartition("/")[2]
    text = f"{name} {detection.score:.2f}" if name else "unknown"
    if detection.status.name not in ("OK", "UNKNOWN_OBJECT"):
        text += f" {detection.status.name}"
    axes.annotate(text, _seen(t_sensor_world, _place(detection))[:, 0], xytext=(40, -40), textcoords="offset points",
                  arrowprops={"arrowstyle": "-", "color": "white"},
                  bbox={"boxstyle": "round", "facecolor": "white", "linewidth": 0})
    if detection.pose is None:
        return
    for k, color in enumerate(("#ff0000", "#00ff00", "#0000ff")):
        _line(axes, t_sensor_world, detection.pose, [[0, 0, 0], np.eye(3)[k] * _AXIS_M], color)
    for grasp in detection.grasps[:1]:
        _draw_grasp(axes, t_sensor_world, grasp)


def _draw_grasp(axes: Any, t_sensor_world: FloatArray, grasp: "GraspProposal") -> None:
    """The approach along the tool's z axis; the fingers open along its x axis, as in grasps that are taught from CAD."""
    half = grasp.gripper_opening_m / 2
    _line(axes, t_sensor_world, grasp.tcp_pose, [[0, 0, -grasp.approach_distance_m], [0, 0, -_AXIS_M]], "orange")
    _line(axes, t_sensor_world, grasp.tcp_pose,
          [[-half, 0, 0], [-half, 0, -_AXIS_M], [half, 0, -_AXIS_M], [half, 0, 0]], "orange")


def _place(detection: "Detection") -> FloatArray:
    return detection.centroid if detection.pose is None else detection.pose[:3, 3]


def _line(axes: Any, t_sensor_world: FloatArray, pose: FloatArray, points: Any, color: str) -> None:
    places = np.asarray(points) @ pose[:3, :3].T + pose[:3, 3]
    axes.plot(*_seen(t_sensor_world, places), color=color, linewidth=3)


def _seen(t_sensor_world: FloatArray, places: FloatArray) -> FloatArray:
    return _directions(np.atleast_2d(places) @ t_sensor_world[:3, :3].T + t_sensor_world[:3, 3])


def _directions(points: FloatArray) -> FloatArray:
    out: FloatArray = points[:, :2].T / points[:, 2]
    return out
