// Captures for teaching: the frames in dropped files, and where the object was in each.
import { fromJsonString, toBinary } from "@bufbuild/protobuf";
import { Matrix4 } from "three";
import { CaptureSetSchema, Capture_Split, type CaptureSet, type CapturedStablePose } from "../../gen/graspdb/v1/capture_set_pb";
import { DepthImageSchema, type AxisAlignedBox, type Pose } from "../../gen/graspdb/v1/geometry_pb";
import { matrixOf, moved, poseOf, type Points } from "../base/geometry";
import { readScan, type Scan } from "../files/scan";

const maxCaptures = 100;

export interface Capture {
  scan: Scan;
  objectPose?: Pose;  // T_world_object, of a capture set
}

// What files have of one stable pose. `objectId` and the rest: of a capture set.
export interface Captures {
  captures: Capture[];
  objectId?: string;
  displayName?: string;
  stablePose?: CapturedStablePose;
  region?: AxisAlignedBox;
  leftOut: string;  // in words; empty: none
}

const baseName = (path: string): string => path.slice(path.lastIndexOf("/") + 1);
const hasFaces = async (file: File): Promise<boolean> => /^element face [1-9]/m.test(await file.slice(0, 64 * 1024).text());
export const isMesh = async (file: File): Promise<boolean> => /\.(stl|obj)$/i.test(file.name) || (/\.ply$/i.test(file.name) && await hasFaces(file));
const isFrame = (file: File): boolean => /\.(pcd|ply|png)$/i.test(file.name);

// The first stable pose of a set that has captures among the files.
function fromSet(set: CaptureSet, files: File[]): { chosen: CaptureSet["captures"]; rest: number } {
  const names = new Set(files.map((each) => each.name));
  const usable = set.captures.filter((each) => each.split !== Capture_Split.QUERY && each.stablePoseId !== "" && names.has(baseName(each.path)));
  const chosen = usable.filter((each) => each.objectId === usable[0]?.objectId && each.stablePoseId === usable[0].stablePoseId);
  return { chosen, rest: usable.length - chosen.length };
}

// The captures in dropped files: of captures.json, if it is among them, else one for each point file or depth image, by
// name. Throws where there are none.
export async function readCaptures(files: File[]): Promise<Captures> {
  const intrinsics = files.filter((each) => /\.json$/i.test(each.name) && each.name !== "captures.json");
  const read = (file: File): Promise<Scan> => readScan([file, ...intrinsics]);
  const setFile = files.find((each) => each.name === "captures.json");
  if (!setFile) {
    const frames = files.filter(isFrame).sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
    if (frames.length === 0) throw new Error("drop PCD or PLY files, 16-bit PNGs with their intrinsics.json, or a capture set's captures.json with its clouds");
    const captures: Capture[] = [];
    for (const file of frames.slice(0, maxCaptures)) captures.push({ scan: await read(file) });
    return { captures, leftOut: frames.length > maxCaptures ? `${frames.length - maxCaptures} files: at most ${maxCaptures} captures at once` : "" };
  }
  const set = fromJsonString(CaptureSetSchema, await setFile.text(), { ignoreUnknownFields: true });
  const { chosen, rest } = fromSet(set, files);
  if (chosen.length === 0) throw new Error("captures.json: none of its captures for teaching is among the dropped files; drop its clouds with it");
  const captures: Capture[] = [];
  for (const each of chosen.slice(0, maxCaptures)) {
    const scan = await read(files.find((file) => file.name === baseName(each.path))!);
    captures.push({ scan: { ...scan, sensorPose: each.sensorPose ?? scan.sensorPose, segmented: each.segmented }, objectPose: each.objectPose });
  }
  const object = set.objects.find((each) => each.objectId === chosen[0]!.objectId);
  return {
    captures, objectId: chosen[0]!.objectId, displayName: object?.displayName ?? "",
    stablePose: object?.stablePoses.find((each) => each.stablePoseId === chosen[0]!.stablePoseId),
    region: set.regionOfInterest,
    leftOut: [rest > 0 && `${rest} captures of other stable poses`, chosen.length > maxCaptures && `${chosen.length - maxCaptures} captures: at most ${maxCaptures} at once`].filter(Boolean).join(", "),
  };
}

// T_world_object on a turntable at x, y (m), turned counter-clockwise as seen from above.
export const turnedPose = (x: number, y: number, turnDeg: number): Pose =>
  poseOf(new Matrix4().makeRotationZ((turnDeg * Math.PI) / 180).setPosition(x, y, 0));

// As the server takes it for a frame without a region.
const standardRegion = { min: { x: -0.5, y: -0.5, z: -0.05 }, max: { x: 0.5, y: 0.5, z: 0.6 } };
const tableEnd = 0.006;  // as PipelineParameters.plane_distance_m

// The points of a capture that lie in the region and above the table, in the object's frame, or in that of the world
// without an object pose. All points where the sensor pose is unknown.
export function shownPoints(scan: Scan, sensorPose: Pose | undefined, objectPose: Pose | undefined, region: AxisAlignedBox | undefined): Points {
  if (!sensorPose) return scan.points;
  const world = moved(scan.points, matrixOf(sensorPose));
  const min = region?.min ?? standardRegion.min;
  const max = region?.max ?? standardRegion.max;
  const kept = new Float32Array(world.length);
  let size = 0;
  for (let i = 0; i < world.length; i += 3) {
    const [x, y, z] = [world[i]!, world[i + 1]!, world[i + 2]!];
    const isInside = x >= min.x && x <= max.x && y >= min.y && y <= max.y && z >= min.z && z <= max.z;
    if (!scan.segmented && (!isInside || z < tableEnd)) continue;
    kept.set([x, y, z], size);
    size += 3;
  }
  return moved(kept.subarray(0, size), matrixOf(objectPose).invert());
}

// Made from the content, as `graspdb` makes it, so that the same capture is taught once.
export async function viewIdOf(scan: Pick<Scan, "message">): Promise<string> {
  const bytes = scan.message.case === "cloud" ? scan.message.value.data : toBinary(DepthImageSchema, scan.message.value);
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes as Uint8Array<ArrayBuffer>));
  return [...digest.subarray(0, 10)].map((each) => each.toString(16).padStart(2, "0")).join("");
}
