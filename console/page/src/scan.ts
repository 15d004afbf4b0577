// The frame that is recognised.
import type { DepthImage, PointCloud, Pose } from "../gen/graspdb/v1/geometry_pb";
import { depthImage, readDepthPng, readIntrinsics, type Camera } from "./depth_file";
import { pointsOfCloud, pointsOfDepth, type Points } from "./geometry";
import { maxFileBytes, readPcd, readPly } from "./point_file";

export interface Scan {
  name: string;
  message: { case: "cloud"; value: PointCloud } | { case: "depthImage"; value: DepthImage };
  points: Points;  // sensor frame
  sensorPose?: Pose;
  segmented: boolean;
}

export const cloudScan = (name: string, cloud: PointCloud, sensorPose: Pose | undefined, segmented: boolean): Scan =>
  ({ name, message: { case: "cloud", value: cloud }, points: pointsOfCloud(cloud), sensorPose, segmented });

async function bytesOf(file: File): Promise<Uint8Array> {
  if (file.size > maxFileBytes) throw new Error(`${file.name} is larger than ${maxFileBytes >> 20} MiB`);
  return new Uint8Array(await file.arrayBuffer());
}

// The scan in dropped files: a PCD or PLY file, or a depth image with intrinsics.json. `camera`: where there is no
// such file.
export async function readScan(files: File[], camera: () => Camera | undefined): Promise<Scan> {
  const file = files.find((each) => /\.(pcd|ply|png)$/i.test(each.name));
  if (!file) throw new Error("drop a PCD or PLY file, or a 16-bit PNG with its intrinsics.json");
  try {
    const bytes = await bytesOf(file);
    if (/\.png$/i.test(file.name)) {
      const json = files.find((each) => /\.json$/i.test(each.name));
      const used = json ? readIntrinsics(new TextDecoder().decode(await bytesOf(json))) : camera();
      if (!used) throw new Error("drop its intrinsics.json with it, or fill in the camera");
      const image = depthImage(await readDepthPng(bytes), used);
      return { name: file.name, message: { case: "depthImage", value: image }, points: pointsOfDepth(image), segmented: false };
    }
    const { cloud, sensorPose } = /\.pcd$/i.test(file.name) ? readPcd(bytes) : readPly(bytes);
    return cloudScan(file.name, cloud, sensorPose, false);
  } catch (error) {
    throw new Error(`${file.name}: ${error instanceof Error ? error.message : String(error)}`);
  }
}

