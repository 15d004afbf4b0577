// Triangle meshes, their measures, and which side of them is outside.
import { Box3, Matrix4, Vector3 } from "three";

// The corners of a triangle turn counter-clockwise seen from outside.
export interface TriangleMesh {
  vertices: Float32Array;  // x, y, z
  triangles: Uint32Array;  // three positions among the vertices
}

export const vertexAt = (mesh: TriangleMesh, i: number, out = new Vector3()): Vector3 => out.fromArray(mesh.vertices, 3 * i);

export function forEachTriangle(mesh: TriangleMesh, use: (a: Vector3, b: Vector3, c: Vector3, i: number) => void): void {
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  const { triangles } = mesh;
  for (let i = 0; 3 * i < triangles.length; ++i) {
    use(vertexAt(mesh, triangles[3 * i]!, a), vertexAt(mesh, triangles[3 * i + 1]!, b), vertexAt(mesh, triangles[3 * i + 2]!, c), i);
  }
}

export const boundsOf = (mesh: TriangleMesh): Box3 => new Box3().setFromArray(mesh.vertices);

export function areaOf(mesh: TriangleMesh): number {
  let sum = 0;
  const cross = new Vector3();
  const side = new Vector3();
  forEachTriangle(mesh, (a, b, c) => (sum += cross.subVectors(b, a).cross(side.subVectors(c, a)).length() / 2));
  return sum;
}

export function transformed(mesh: TriangleMesh, matrix: Matrix4): TriangleMesh {
  const vertices = new Float32Array(mesh.vertices.length);
  const v = new Vector3();
  for (let i = 0; i < vertices.length; i += 3) v.fromArray(mesh.vertices, i).applyMatrix4(matrix).toArray(vertices, i);
  return { vertices, triangles: mesh.triangles };
}

// In metres. `metres`: the length of the unit of `mesh`.
export function scaled(mesh: TriangleMesh, metres: number): TriangleMesh {
  const factor = Math.fround(metres);
  return { vertices: mesh.vertices.map((each) => each * factor), triangles: mesh.triangles };
}

// Signed volume and centre of the solid; undefined where it encloses none.
export function solidOf(mesh: TriangleMesh): { volume: number; center: Vector3 } | undefined {
  const box = boundsOf(mesh);
  const apex = box.getCenter(new Vector3());
  const size = box.getSize(new Vector3());
  const moment = new Vector3();
  const cross = new Vector3();
  let volume = 0;
  forEachTriangle(mesh, (a, b, c) => {
    a.sub(apex);
    b.sub(apex);
    c.sub(apex);
    const part = a.dot(cross.crossVectors(b, c)) / 6;
    volume += part;
    moment.addScaledVector(a.add(b).add(c), part / 4);
  });
  if (!(Math.abs(volume) > 1e-6 * size.x * size.y * size.z)) return undefined;
  return { volume, center: apex.addScaledVector(moment, 1 / volume) };
}

// Neighbouring triangles, which share an edge with each other only, and whether they turn against each other.
function neighboursIn(mesh: TriangleMesh): [number, number, boolean][] {
  const { triangles } = mesh;
  const first = new Map<number, { triangle: number; other: number; isForward: boolean; isOpposed: boolean; count: number }>();
  const size = mesh.vertices.length / 3;
  for (let at = 0; at < triangles.length; ++at) {
    const triangle = Math.floor(at / 3);
    const [from, to] = [triangles[at]!, triangles[at % 3 === 2 ? at - 2 : at + 1]!];
    if (from === to) continue;
    const key = Math.min(from, to) * size + Math.max(from, to);
    const edge = first.get(key);
    if (!edge) first.set(key, { triangle, other: -1, isForward: from < to, isOpposed: false, count: 1 });
    else if (++edge.count === 2) {
      edge.other = triangle;
      edge.isOpposed = edge.isForward === from < to;
    }
  }
  return [...first.values()].filter((each) => each.count === 2).map((each) => [each.triangle, each.other, each.isOpposed]);
}

// Share of the pairs of neighbours that turn against each other: after turnOutwards, of surfaces with one side only.
export function opposedShare(mesh: TriangleMesh): number {
  const pairs = neighboursIn(mesh);
  return pairs.filter(([, , isOpposed]) => isOpposed).length / Math.max(1, pairs.length);
}

function turn(triangles: Uint32Array, i: number): void {
  const kept = triangles[3 * i + 1]!;
  triangles[3 * i + 1] = triangles[3 * i + 2]!;
  triangles[3 * i + 2] = kept;
}

// Turns neighbours alike, each connected surface as most of its area is, and then the solid outwards.
export function turnOutwards(mesh: TriangleMesh): void {
  const count = mesh.triangles.length / 3;
  const beside: [number, boolean][][] = Array.from({ length: count }, () => []);
  for (const [a, b, isOpposed] of neighboursIn(mesh)) {
    beside[a]!.push([b, isOpposed]);
    beside[b]!.push([a, isOpposed]);
  }
  const areas = new Float64Array(count);
  forEachTriangle(mesh, (a, b, c, i) => (areas[i] = b.sub(a).cross(c.sub(a)).length() / 2));
  const turned = new Int8Array(count);  // 0: not reached, 1: as the first one of its surface, -1: against it
  for (let start = 0; start < count; ++start) {
    if (turned[start] !== 0) continue;
    turned[start] = 1;
    const surface = [start];
    let balance = 0;
    for (let at = 0; at < surface.length; ++at) {
      const i = surface[at]!;
      balance += turned[i]! * areas[i]!;
      for (const [other, isOpposed] of beside[i]!) {
        if (turned[other] !== 0) continue;
        turned[other] = isOpposed ? -turned[i]! : turned[i]!;
        surface.push(other);
      }
    }
    for (const i of surface) if (turned[i]! * balance < 0) turn(mesh.triangles, i);
  }
  const solid = solidOf(mesh);
  if (!solid || solid.volume > 0) return;
  for (let i = 0; i < count; ++i) turn(mesh.triangles, i);
}
