// The points of a stable pose: those of its views, in the frame of the object.
import { Box3, Vector3 } from "three";
import type { View } from "../../gen/graspdb/v1/catalog_pb";
import { fullView } from "../base/api";
import { matrixOf, moved, pointsOfCloud, type Points } from "../base/geometry";

export const maxDrawnViews = 36;

// The points of a view in the frame of its object.
export async function pointsInObjectFrame(name: string): Promise<Points> {
  const view = await fullView(name);
  const objectOfSensor = matrixOf(view.objectPose).invert().multiply(matrixOf(view.sensorPose));
  return moved(pointsOfCloud(view.cloud), objectOfSensor);
}

// Evenly chosen views where there are many. Views without an object pose of their own do not share a frame: the first of
// these, if there are no others.
export function viewsToDraw(views: View[]): View[] {
  const shared = views.filter((each) => !each.objectPoseEstimated);
  const usable = shared.length > 0 ? shared : views.slice(0, 1);
  const every = Math.max(1, usable.length / maxDrawnViews);
  return Array.from({ length: Math.min(usable.length, maxDrawnViews) }, (_, i) => usable[Math.floor(i * every)]!);
}

export function boxOf(clouds: Points[]): Box3 {
  const box = new Box3();
  const point = new Vector3();
  for (const points of clouds) {
    for (let at = 0; at < points.length; at += 3) box.expandByPoint(point.set(points[at]!, points[at + 1]!, points[at + 2]!));
  }
  return box;
}
