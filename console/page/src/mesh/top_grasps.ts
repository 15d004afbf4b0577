// Grasps from above, computed from the shape of an object: as client/teaching/mesh/top_grasps.cc proposes them.
import { create } from "@bufbuild/protobuf";
import { Matrix4, Vector3 } from "three";
import { GraspSchema, type Grasp } from "../../gen/graspdb/v1/catalog_pb";
import { poseOf } from "../base/geometry";
import { areaOf, boundsOf, forEachTriangle, type TriangleMesh } from "./triangle_mesh";

// A gripper with two parallel fingers, metres.
const gripper = { maxOpening: 0.085, fingerWidth: 0.020, fingerLength: 0.060, padHeight: 0.016 };
const offTable = 0.002;
const approach = 0.10;
const samples = 12_000;
const closingDirections = 24;  // over half a turn
const minPlay = 0.003;         // on each side of the object when the gripper comes down
const play = 0.010;            // on each side, if it can open that far
const touchDepth = 0.0015;
const minCosine = 0.9397;      // of 20 degrees
const maxLever = 0.5;          // share of the object's reach from its centre of mass
const minTouch = 8e-6;         // m^2
const fullContact = 0.85;
const equalValue = 1e-3;       // of equal grasps the first one is proposed
const otherGrasp = Math.PI / 4;

interface Samples { points: Vector3[]; normals: Vector3[]; areas: number[] }
interface Candidate { closing: number; tcp: Vector3; width: number; value: number }

// The axis that the normal is most along; an earlier one is preferred where they are equal but for rounding.
function mainAxis(normal: Vector3): number {
  const size = [Math.abs(normal.x), Math.abs(normal.y), Math.abs(normal.z)];
  return [1, 2].reduce((axis, other) => size[other]! > size[axis]! * 1.001 ? other : axis, 0);
}

// Where lines of a grid cross the surface, so that the points do not depend on how it is divided into triangles.
function sampledEvenly(mesh: TriangleMesh): Samples {
  const out: Samples = { points: [], normals: [], areas: [] };
  const area = areaOf(mesh);
  if (!(area > 0)) return out;
  const box = boundsOf(mesh);
  const size = box.getSize(new Vector3());
  const spacing = Math.max(Math.sqrt(area / samples), Math.max(size.x, size.y, size.z) / 1000);
  const first = box.min.clone().subScalar(0.381966 * spacing).toArray();
  const line = (axis: number, i: number): number => first[axis]! + i * spacing;
  const from = (axis: number, x: number): number => Math.ceil((x - first[axis]!) / spacing);
  forEachTriangle(mesh, (a, b, c) => {
    const normal = b.clone().sub(a).cross(c.clone().sub(a));
    if (!(normal.length() > 0)) return;
    normal.normalize();
    const n = normal.toArray();
    const corners = [a, b, c].map((each) => each.toArray());
    const axis = mainAxis(normal);
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const high = Math.max(...corners.map((each) => each[v]!));
    for (let row = from(v, Math.min(...corners.map((each) => each[v]!))); line(v, row) < high; ++row) {
      const at = line(v, row);
      const crossings = corners.flatMap((corner, k) => {
        const next = corners[(k + 1) % 3]!;
        const [low, top] = corner[v]! > next[v]! ? [next, corner] : [corner, next];
        if (at < low[v]! || at >= top[v]!) return [];
        return [low[u]! + ((at - low[v]!) / (top[v]! - low[v]!)) * (top[u]! - low[u]!)];
      });
      if (crossings.length !== 2) continue;
      const last = Math.max(...crossings);
      for (let column = from(u, Math.min(...crossings)); line(u, column) < last && out.areas.length < 2 * samples; ++column) {
        const p = corners[0]!.slice();
        p[u] = line(u, column);
        p[v] = at;
        p[axis]! -= [0, 1, 2].reduce((sum, k) => sum + n[k]! * (p[k]! - corners[0]![k]!), 0) / n[axis]!;
        out.points.push(new Vector3().fromArray(p));
        out.normals.push(normal);
        out.areas.push((spacing * spacing) / Math.abs(n[axis]!));
      }
    }
  });
  return out;
}

// The first of those that are as good as the best one.
function firstOfBest(candidates: Candidate[]): Candidate | undefined {
  const best = candidates.reduce((most, each) => Math.max(most, each.value), -Infinity);
  return candidates.find((each) => each.value >= best - equalValue);
}

// The object turned so that the fingers close along x.
class Turned {
  private readonly points: Vector3[];
  private readonly areas: number[];
  private readonly cosines: number[];  // of the normals to x
  private readonly mass: Vector3;
  private readonly top: number;
  private readonly reach: number;  // across the table, from the centre of mass

  constructor(surface: Samples, mass: Vector3, private readonly closing: number) {
    const turn = new Matrix4().makeRotationZ(-closing);
    this.areas = surface.areas;
    this.mass = mass.clone().applyMatrix4(turn);
    this.points = surface.points.map((each) => each.clone().applyMatrix4(turn));
    this.cosines = surface.normals.map((each) => each.x * turn.elements[0]! + each.y * turn.elements[4]!);
    this.top = this.points.reduce((most, p) => Math.max(most, p.z), 0);
    this.reach = this.points.reduce((most, p) => Math.max(most, Math.hypot(p.x - this.mass.x, p.y - this.mass.y)), 0);
  }

  best(): Candidate | undefined {
    const out: Candidate[] = [];
    const deep = Math.max(offTable, this.mass.z - gripper.padHeight / 2);
    const step = gripper.fingerWidth / 4;
    const steps = Math.ceil(this.reach / step);
    for (const tips of [offTable, deep, this.top - gripper.padHeight]) {
      if (tips < Math.max(offTable, this.top - gripper.fingerLength)) continue;
      for (let k = -steps; k <= steps; ++k) {
        const found = this.at(this.mass.y + k * step, tips);
        if (found) out.push(found);
      }
    }
    return firstOfBest(out);
  }

  // With the middle of the fingers at y and their tips at height `tips`.
  private at(y: number, tips: number): Candidate | undefined {
    const swept: number[] = [];
    let [low, high] = [Infinity, -Infinity];
    this.points.forEach((p, i) => {
      if (Math.abs(p.y - y) > gripper.fingerWidth / 2 || p.z < tips) return;
      low = Math.min(low, p.x);
      high = Math.max(high, p.x);
      if (p.z <= tips + gripper.padHeight) swept.push(i);
    });
    const width = high - low;
    if (!(width + 2 * minPlay <= gripper.maxOpening) || low > high) return undefined;
    let [onLow, onHigh] = [0, 0];
    for (const i of swept) {
      const { x } = this.points[i]!;
      if (x < low + touchDepth && this.cosines[i]! < -minCosine) onLow += this.areas[i]!;
      if (x > high - touchDepth && this.cosines[i]! > minCosine) onHigh += this.areas[i]!;
    }
    const touching = Math.min(onLow, onHigh);
    if (touching < minTouch) return undefined;
    const x = (low + high) / 2;
    const lever = Math.hypot(y - this.mass.y, x - this.mass.x);
    if (lever > maxLever * this.reach) return undefined;
    const value = Math.min(1, touching / (fullContact * gripper.fingerWidth * gripper.padHeight)) - (2 * lever + 0.5 * width) / gripper.maxOpening;
    const tcp = new Vector3(x, y, tips + gripper.padHeight / 2).applyMatrix4(new Matrix4().makeRotationZ(this.closing));
    return { closing: this.closing, tcp, width, value };
  }
}

function graspOf(found: Candidate, graspId: string, priority: number): Grasp {
  const pose = new Matrix4().makeRotationZ(found.closing).multiply(new Matrix4().makeRotationX(Math.PI)).setPosition(found.tcp);
  return create(GraspSchema, {
    graspId, tcpPose: poseOf(pose), approachDistanceM: approach, retreatDistanceM: approach,
    gripperOpeningM: Math.min(found.width + 2 * play, gripper.maxOpening), priority,
  });
}

// At most two, the second one closing at 45 degrees or more from the first; one for an object that looks the same after any turn.
// `mesh` and `mass`: in the object's frame.
export function proposeTopGrasps(mesh: TriangleMesh, mass: Vector3, anyTurn: boolean): Grasp[] {
  const surface = sampledEvenly(mesh);
  const found: Candidate[] = [];
  for (let k = 0; k < (anyTurn ? 1 : closingDirections); ++k) {
    const best = new Turned(surface, mass, (Math.PI * k) / closingDirections).best();
    if (best) found.push(best);
  }
  const best = firstOfBest(found);
  if (!best) return [];
  const apart = (a: number, b: number): number => {
    const between = Math.abs(a - b) % Math.PI;
    return Math.min(between, Math.PI - between);
  };
  const other = anyTurn ? undefined : firstOfBest(found.filter((each) => apart(each.closing, best.closing) >= otherGrasp - 1e-9));
  return [graspOf(best, "top", 1), ...(other ? [graspOf(other, "top-2", 0)] : [])];
}
