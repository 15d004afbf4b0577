// Views of a mesh as a cell's camera would take them: as client/teaching/upload/cad_views.cc renders them. The camera stands still, and the
// object turns about its z axis.
import { create } from "@bufbuild/protobuf";
import { Matrix4, Vector3 } from "three";
import type { Cell } from "../../gen/graspdb/v1/cell_pb";
import { DepthImageSchema, type AxisAlignedBox, type DepthImage } from "../../gen/graspdb/v1/geometry_pb";
import { matrixOf, type Points } from "../base/geometry";
import { DepthCamera, intrinsics, lookAt, maxDepth, minDepth, randomBits, type DepthFrame } from "./depth_camera";
import type { MeshStablePose } from "./stable_poses";
import { transformed, type TriangleMesh } from "./triangle_mesh";

const minFall = 0.05;         // a camera whose axis falls by less per metre does not look at the table
const minSeenPixels = 30;
const regionMargin = 0.05;    // m, around the turning object
const noCount = 65535;

export const standardStand = { distance: 0.8, lookDownDeg: 40, stepDeg: 20 };

export interface MeshView {
  poseId: string;
  turnDeg: number;         // of T_world_object about z
  image: DepthImage;
  points: Points;          // of the object alone, in its frame
  seen: Seen;
}

// The pixels that show the object: a square around them, and the depths there, m.
export interface Seen { left: number; top: number; side: number; near: number; far: number }

export interface Region { min: { x: number; y: number; z: number }; max: { x: number; y: number; z: number } }

export const worldObjectOf = (turnDeg: number): Matrix4 => new Matrix4().makeRotationZ((turnDeg * Math.PI) / 180);

// T_world_sensor for the object at the origin: of a cell's camera, as it looks at its table.
export function standOfCell(cell: Cell): Matrix4 {
  if (!cell.sensorPose) throw new Error(`${cell.name} has no sensor pose; calibrate it, or choose no cell and give the angle and distance`);
  const sensor = matrixOf(cell.sensorPose);
  const at = new Vector3().setFromMatrixPosition(sensor);
  const axis = new Vector3().setFromMatrixColumn(sensor, 2);
  const isDown = axis.z < -minFall && at.z > 0;
  let target = isDown ? at.clone().addScaledVector(axis, -at.z / axis.z) : new Vector3();
  const { min, max } = cell.regionOfInterest ?? ({} as Partial<AxisAlignedBox>);
  if (min && max) {
    const isWithin = target.x >= min.x && target.x <= max.x && target.y >= min.y && target.y <= max.y;
    if (!isDown || !isWithin) target = new Vector3((min.x + max.x) / 2, (min.y + max.y) / 2, 0);
  } else if (!isDown) throw new Error(`the camera of ${cell.name} does not look down at the table; check its sensor pose`);
  return sensor.setPosition(at.sub(target));
}

export const standOf = (distance: number, lookDownDeg: number): Matrix4 => lookAt(distance, (lookDownDeg * Math.PI) / 180, -Math.PI / 2);

// The turns of an object: 0, step, 2 step, … below 360 degrees.
export function turnsOf(stepDeg: number): number[] {
  if (!(stepDeg >= 1 && stepDeg <= 120)) throw new Error("the step of the turntable is not between 1 and 120 degrees; the usual one is 20");
  return Array.from({ length: Math.ceil(360 / stepDeg - 1e-9) }, (_, i) => i * stepDeg);
}

// The region that the mesh sweeps when it turns about z.
export function regionOf(mesh: TriangleMesh): Region {
  let radius = 0;
  let height = 0;
  for (let i = 0; i < mesh.vertices.length; i += 3) {
    radius = Math.max(radius, Math.hypot(mesh.vertices[i]!, mesh.vertices[i + 1]!));
    height = Math.max(height, mesh.vertices[i + 2]!);
  }
  const half = Math.max(0.30, radius + regionMargin);
  return { min: { x: -half, y: -half, z: -0.02 }, max: { x: half, y: half, z: Math.max(0.40, height + regionMargin) } };
}

// Depth of the farthest corner.
function farthestDepth({ min, max }: Region, worldSensor: Matrix4): number {
  const axis = new Vector3().setFromMatrixColumn(worldSensor, 2);
  const corner = new Vector3(axis.x > 0 ? max.x : min.x, axis.y > 0 ? max.y : min.y, axis.z > 0 ? max.z : min.z);
  return axis.dot(corner.sub(new Vector3().setFromMatrixPosition(worldSensor)));
}

// In the finest unit with which 16 bits reach `far`; farther depths are no measurement.
export function imageOf(depth: Float32Array, far: number): DepthImage {
  const depthUnitM = far / (noCount - 1);
  const data = new DataView(new ArrayBuffer(2 * depth.length));
  depth.forEach((each, i) => {
    const value = each > 0 ? Math.round(each / depthUnitM) : 0;
    data.setUint16(2 * i, value < noCount ? value : 0, true);
  });
  return create(DepthImageSchema, { intrinsics, depthUnitM, data: new Uint8Array(data.buffer) });
}

function pointsOf(frame: DepthFrame, objectSensor: Matrix4): Points {
  const out: number[] = [];
  const p = new Vector3();
  const { width, fx, fy, cx, cy } = intrinsics;
  frame.depth.forEach((z, i) => {
    if (!frame.isObject[i] || !(z > 0)) return;
    p.set((((i % width) - cx) / fx) * z, ((Math.floor(i / width) - cy) / fy) * z, z).applyMatrix4(objectSensor);
    out.push(p.x, p.y, p.z);
  });
  return new Float32Array(out);
}

function seenOf(frame: DepthFrame): Seen {
  const out = { left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity, near: Infinity, far: -Infinity };
  frame.depth.forEach((z, i) => {
    if (!frame.isObject[i]) return;
    const [u, v] = [i % intrinsics.width, Math.floor(i / intrinsics.width)];
    out.left = Math.min(out.left, u);
    out.right = Math.max(out.right, u);
    out.top = Math.min(out.top, v);
    out.bottom = Math.max(out.bottom, v);
    out.near = Math.min(out.near, z);
    out.far = Math.max(out.far, z);
  });
  const side = Math.ceil(1.3 * Math.max(out.right - out.left, out.bottom - out.top, 8));
  return { left: Math.round((out.left + out.right - side) / 2), top: Math.round((out.top + out.bottom - side) / 2), side, near: out.near, far: out.far };
}

// Stable poses have noise of their own (FNV-1a of their names).
const hashOf = (name: string): number => [...name].reduce((hash, c) => Math.imul(hash ^ c.charCodeAt(0), 0x01000193) >>> 0, 0x811c9dc5);

// The views of all poses. `report`: after each view. Throws where the camera does not see the object.
export function renderViews(
  mesh: TriangleMesh, poses: MeshStablePose[], worldSensor: Matrix4, stepDeg: number, objectId: string, report: (done: number, all: number) => void,
): MeshView[] {
  const turns = turnsOf(stepDeg);
  const camera = new DepthCamera();
  const out: MeshView[] = [];
  try {
    for (const pose of poses) {
      const posed = transformed(mesh, pose.objectMesh);
      const far = farthestDepth(regionOf(posed), worldSensor);
      camera.show(posed);
      for (const turnDeg of turns) {
        const worldObject = worldObjectOf(turnDeg);
        const frame = camera.frame(worldObject, worldSensor, randomBits(hashOf(`${objectId}/${pose.id}`), Math.round(turnDeg * 1000)));
        if (frame.isObject.reduce((sum, each) => sum + each, 0) < minSeenPixels) {
          throw new Error(`no part of the object is visible in ${pose.id}; the camera measures from ${minDepth} to ${maxDepth} m, choose another distance or check the cell's pose`);
        }
        out.push({ poseId: pose.id, turnDeg, image: imageOf(frame.depth, far), points: pointsOf(frame, worldObject.invert().multiply(worldSensor)), seen: seenOf(frame) });
        report(out.length, poses.length * turns.length);
      }
    }
  } finally {
    camera.dispose();
  }
  return out;
}
