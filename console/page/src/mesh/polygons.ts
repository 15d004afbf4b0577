// Faces of any number of corners, as triangles.
import { ShapeUtils, Vector2 } from "three";

const maxCorners = 10_000;  // of a face, as graspdb teach

export interface PolygonMesh { vertices: Float32Array; triangles: number[]; comments: string }

// The corners of a polygon on the plane of two axes in which it is largest, counter-clockwise.
function flattened(vertices: Float32Array, polygon: number[]): Vector2[] {
  const normal = [0, 0, 0];
  polygon.forEach((a, i) => {
    const b = polygon[(i + 1) % polygon.length]!;
    for (let k = 0; k < 3; ++k) {
      const [u, v] = [(k + 1) % 3, (k + 2) % 3];
      normal[k]! += (vertices[3 * a + u]! - vertices[3 * b + u]!) * (vertices[3 * a + v]! + vertices[3 * b + v]!);
    }
  });
  const axis = [1, 2].reduce((most, k) => Math.abs(normal[k]!) > Math.abs(normal[most]!) ? k : most, 0);
  const [u, v] = normal[axis]! < 0 ? [(axis + 2) % 3, (axis + 1) % 3] : [(axis + 1) % 3, (axis + 2) % 3];
  return polygon.map((i) => new Vector2(vertices[3 * i + u]!, vertices[3 * i + v]!));
}

// Appends the triangles of a polygon, which may be concave.
function addTriangles(vertices: Float32Array, polygon: number[], out: number[]): void {
  if (polygon.length < 3) return;  // a point or a line
  if (polygon.length === 3) return void out.push(...polygon);
  const at = flattened(vertices, polygon);
  for (const [a, b, c] of ShapeUtils.triangulateShape([...at], []) as [number, number, number][]) {
    const isForward = at[b]!.clone().sub(at[a]!).cross(at[c]!.clone().sub(at[a]!)) > 0;
    out.push(polygon[a]!, polygon[isForward ? b : c]!, polygon[isForward ? c : b]!);
  }
}

function checkPolygon(polygon: number[], vertexCount: number): void {
  if (polygon.length === 0) throw new Error("a face has no corners");
  if (polygon.length > maxCorners) {
    throw new Error(`a face has ${polygon.length.toLocaleString("en")} corners, and at most ${maxCorners.toLocaleString("en")} are read; export it with triangles`);
  }
  for (const i of polygon) if (!Number.isInteger(i) || i < 0 || i >= vertexCount) throw new Error("a face has a corner that is not a vertex");
}

// Of faces whose corners are positions among the vertices. `checkCount`: throws where there are too many triangles. Throws where a face
// is none.
export function trianglesOf(vertices: Float32Array, polygons: number[][], checkCount: (triangles: number) => void): number[] {
  polygons.forEach((each) => checkPolygon(each, vertices.length / 3));
  checkCount(polygons.reduce((sum, each) => sum + Math.max(0, each.length - 2), 0));
  const out: number[] = [];
  for (const polygon of polygons) addTriangles(vertices, polygon, out);
  return out;
}
