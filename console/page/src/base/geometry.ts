// Poses of the contract for three.js, and points out of its messages.
import { create } from "@bufbuild/protobuf";
import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import { PackedElementField_NumericType as NumericType, PoseSchema, type DepthImage, type PointCloud, type Pose } from "../../gen/graspdb/v1/geometry_pb";

export function matrixOf(pose: Pose | undefined): Matrix4 {
  if (!pose) return new Matrix4();
  const p = pose.position;
  const q = pose.orientation;
  return new Matrix4().compose(
    new Vector3(p?.x ?? 0, p?.y ?? 0, p?.z ?? 0),
    q ? new Quaternion(q.x, q.y, q.z, q.w).normalize() : new Quaternion(), new Vector3(1, 1, 1));
}

// `matrix`: a rotation and a translation.
export function poseOf(matrix: Matrix4): Pose {
  const position = new Vector3();
  const turn = new Quaternion();
  matrix.decompose(position, turn, new Vector3());
  return create(PoseSchema, {
    position: { x: position.x, y: position.y, z: position.z }, orientation: { x: turn.x, y: turn.y, z: turn.z, w: turn.w },
  });
}

// A pose as people type it: millimetres, and turns about x, y and z of the outer frame, in this order, in degrees.
export const poseLabels = ["x", "y", "z", "roll", "pitch", "yaw"] as const;

export function numbersOfPose(pose: Pose | undefined): number[] {
  const matrix = matrixOf(pose);
  const position = new Vector3().setFromMatrixPosition(matrix);
  const turn = new Euler().setFromRotationMatrix(matrix, "ZYX");
  return [...position.toArray().map((each) => each * 1000), ...[turn.x, turn.y, turn.z].map((each) => (each * 180) / Math.PI)];
}

export function poseOfNumbers(numbers: number[]): Pose {
  const [x, y, z, roll, pitch, yaw] = numbers as [number, number, number, number, number, number];
  const turn = new Euler((roll * Math.PI) / 180, (pitch * Math.PI) / 180, (yaw * Math.PI) / 180, "ZYX");
  return poseOf(new Matrix4().makeRotationFromEuler(turn).setPosition(x / 1000, y / 1000, z / 1000));
}

// Distance in metres and turn in degrees between two poses.
export function between(a: Pose, b: Pose): { shift: number; turn: number } {
  const from = new Vector3(a.position?.x, a.position?.y, a.position?.z);
  const to = new Vector3(b.position?.x, b.position?.y, b.position?.z);
  const p = a.orientation;
  const q = b.orientation;
  const turn = p && q ? new Quaternion(p.x, p.y, p.z, p.w).angleTo(new Quaternion(q.x, q.y, q.z, q.w)) : 0;
  return { shift: from.distanceTo(to), turn: (turn * 180) / Math.PI };
}

// x, y, z of each measured point, metres, sensor frame.
export type Points = Float32Array;

const isMeasured = (x: number, y: number, z: number): boolean =>
  Number.isFinite(x + y + z) && (x !== 0 || y !== 0 || z !== 0);

export function pointsOfCloud(cloud: PointCloud | undefined): Points {
  const stride = cloud?.pointStride ?? 0;
  if (!cloud || stride <= 0) return new Float32Array();
  const fields = ["x", "y", "z"].map((name) => cloud.fields.find((field) => field.name === name));
  if (fields.some((field) => !field)) return new Float32Array();
  const data = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
  const out = new Float32Array(3 * Math.floor(cloud.data.byteLength / stride));
  let size = 0;
  for (let at = 0; at + stride <= data.byteLength; at += stride) {
    const [x, y, z] = fields.map((field) =>
      field!.type === NumericType.FLOAT64 ? data.getFloat64(at + field!.offset, true) : data.getFloat32(at + field!.offset, true));
    if (!isMeasured(x!, y!, z!)) continue;
    out[size++] = x!;
    out[size++] = y!;
    out[size++] = z!;
  }
  return out.subarray(0, size);
}

export function pointsOfDepth(image: DepthImage): Points {
  const k = image.intrinsics;
  if (!k || k.width <= 0 || k.height <= 0) return new Float32Array();
  const unit = image.depthUnitM || 0.001;
  const data = new DataView(image.data.buffer, image.data.byteOffset, image.data.byteLength);
  const out = new Float32Array(3 * k.width * k.height);
  let size = 0;
  for (let i = 0; i < k.width * k.height && 2 * i + 2 <= data.byteLength; ++i) {
    const value = data.getUint16(2 * i, true);
    if (value === 0 || value === 65535) continue;
    const z = value * unit;
    out[size++] = (((i % k.width) - k.cx) / k.fx) * z;
    out[size++] = ((Math.floor(i / k.width) - k.cy) / k.fy) * z;
    out[size++] = z;
  }
  return out.subarray(0, size);
}

export function moved(points: Points, matrix: Matrix4): Points {
  const out = new Float32Array(points.length);
  const e = matrix.elements;
  for (let i = 0; i < points.length; i += 3) {
    const x = points[i]!;
    const y = points[i + 1]!;
    const z = points[i + 2]!;
    out[i] = e[0]! * x + e[4]! * y + e[8]! * z + e[12]!;
    out[i + 1] = e[1]! * x + e[5]! * y + e[9]! * z + e[13]!;
    out[i + 2] = e[2]! * x + e[6]! * y + e[10]! * z + e[14]!;
  }
  return out;
}
