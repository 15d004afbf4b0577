// The frame that is recognised.
import type { DepthImage, PointCloud, Pose } from "../../gen/graspdb/v1/geometry_pb";
import { RecognitionStatus } from "../../gen/graspdb/v1/recognition_pb";
import type { RecognizeRequest, RecognizeResponse } from "../../gen/graspdb/v1/recognition_service_pb";
import type { Bundle } from "../../gen/graspdb/v1/bundle_pb";
import { readBundle } from "./bundle_file";
import { depthImage, readDepthPng, readIntrinsics, type Camera } from "./depth_file";
import { pointsOfCloud, pointsOfDepth, type Points } from "../base/geometry";
import { maxFileBytes, readPcd, readPly } from "./point_file";

// What a black box stored with a frame.
export interface Recorded {
  time: string;  // UTC
  cell: string;
  robot: string;
  outcome: string;  // a status or an error
  request: RecognizeRequest;
  response?: RecognizeResponse;
  durationMs: number;
}

export interface Scan {
  name: string;
  message: { case: "cloud"; value: PointCloud } | { case: "depthImage"; value: DepthImage };
  points: Points;  // sensor frame
  sensorPose?: Pose;
  segmented: boolean;
  recorded?: Recorded;
}

export const cloudScan = (name: string, cloud: PointCloud, sensorPose: Pose | undefined, segmented: boolean): Scan =>
  ({ name, message: { case: "cloud", value: cloud }, points: pointsOfCloud(cloud), sensorPose, segmented });

function bundleScan(name: string, bundle: Bundle): Scan {
  const request = bundle.request!;
  const { scan } = request;
  if (scan.case === undefined) throw new Error("its request has no scan");
  const response = bundle.result.case === "response" ? bundle.result.value : undefined;
  return {
    name, message: scan, points: scan.case === "cloud" ? pointsOfCloud(scan.value) : pointsOfDepth(scan.value),
    sensorPose: request.sensorPose ?? response?.sensorPose, segmented: request.segmented,
    recorded: {
      time: bundle.requestTime ? new Date(Number(bundle.requestTime.seconds) * 1000).toISOString().slice(0, 19).replace("T", " ") : "",
      cell: request.cell, robot: bundle.robot, request, response, durationMs: bundle.durationMs,
      outcome: response ? (RecognitionStatus[response.status] ?? String(response.status)) : bundle.result.case === "error" ? bundle.result.value.message : "",
    },
  };
}

async function bytesOf(file: File): Promise<Uint8Array> {
  if (file.size > maxFileBytes) throw new Error(`${file.name} is larger than ${maxFileBytes >> 20} MiB`);
  return new Uint8Array(await file.arrayBuffer());
}

// The scan in dropped files: a PCD or PLY file, a depth image with intrinsics.json, or a bundle. `camera`: where there is
// no intrinsics.json; absent: there is no other.
export async function readScan(files: File[], camera?: () => Camera | undefined): Promise<Scan> {
  const file = files.find((each) => /\.(pcd|ply|png|bundle)$/i.test(each.name));
  if (!file) throw new Error("drop a PCD or PLY file, a 16-bit PNG with its intrinsics.json, or a bundle of a black box");
  try {
    const bytes = await bytesOf(file);
    if (/\.bundle$/i.test(file.name)) return bundleScan(file.name, readBundle(bytes));
    if (/\.png$/i.test(file.name)) {
      const json = files.find((each) => /\.json$/i.test(each.name));
      const used = json ? readIntrinsics(new TextDecoder().decode(await bytesOf(json))) : camera?.();
      if (!used) throw new Error(`drop its intrinsics.json with it${camera ? ", or fill in the camera" : ""}`);
      const image = depthImage(await readDepthPng(bytes), used);
      return { name: file.name, message: { case: "depthImage", value: image }, points: pointsOfDepth(image), segmented: false };
    }
    const { cloud, sensorPose } = /\.pcd$/i.test(file.name) ? readPcd(bytes) : readPly(bytes);
    return cloudScan(file.name, cloud, sensorPose, false);
  } catch (error) {
    throw new Error(`${file.name}: ${error instanceof Error ? error.message : String(error)}`);
  }
}

