// The convex hull of a mesh, by three.js, with its plane faces.
import { Vector3 } from "three";
import { ConvexHull as Hull, type Face } from "three/examples/jsm/math/ConvexHull.js";
import { vertexAt, type TriangleMesh } from "./triangle_mesh";

// Neighbours whose normals differ less are one facet, rad: the single precision of mesh files.
const coplanar = 2e-4;
const maxFaces = 200_000;
const minVolume = 1e-8;  // share of the cube of the diameter: less is a plane with rounding errors
const flatText = "the mesh has no convex hull, as when it is flat; give it a thickness";

// A side of a facet, counter-clockwise seen from outside; `neighbor`: the facet beyond it.
export interface HullEdge { from: Vector3; to: Vector3; neighbor: number }

// A plane face: triangles in one plane, normal . x = offset.
export interface HullFacet { normal: Vector3; offset: number; triangles: [Vector3, Vector3, Vector3][]; edges: HullEdge[] }

export interface ConvexHull { points: Vector3[]; facets: HullFacet[] }

// The edges of a face: the triangle's corners are their heads.
const edgesOf = (face: Face): Face["edge"][] => [face.edge, face.edge.next, face.edge.next.next];

// For each face a number, the same for those in one plane.
function planesOf(faces: Face[]): number[] {
  const place = new Map(faces.map((face, i) => [face, i]));
  const parent = faces.map((_, i) => i);
  const root = (i: number): number => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]!]!;
    return i;
  };
  const cross = new Vector3();
  faces.forEach((face, i) => edgesOf(face).forEach((edge) => {
    const other = place.get(edge.twin.face)!;
    if (cross.crossVectors(face.normal, edge.twin.face.normal).length() >= coplanar) return;
    const [a, b] = [root(i), root(other)];
    parent[Math.max(a, b)] = Math.min(a, b);
  }));
  const numbers = new Map<number, number>();
  return faces.map((_, i) => {
    const top = root(i);
    if (!numbers.has(top)) numbers.set(top, numbers.size);
    return numbers.get(top)!;
  });
}

// The mean plane of its triangles, by their areas, through its outermost corner.
function fitPlane(facet: HullFacet): void {
  const area = new Vector3();
  for (const [a, b, c] of facet.triangles) area.add(b.clone().sub(a).cross(c.clone().sub(a)));
  if (area.length() > 0) facet.normal.copy(area).normalize();
  facet.offset = facet.triangles.reduce((most, corners) => Math.max(most, ...corners.map((each) => facet.normal.dot(each))), -Infinity);
}

// Throws where the mesh is flat, or its hull has too many faces.
export function hullOf(mesh: TriangleMesh): ConvexHull {
  const points = Array.from({ length: mesh.vertices.length / 3 }, (_, i) => vertexAt(mesh, i));
  const { faces } = new Hull().setFromPoints(points);
  if (faces.length < 4 || faces.some((face) => !edgesOf(face).every((edge) => edge?.twin))) {
    throw new Error(flatText);
  }
  if (faces.length > maxFaces) throw new Error("the mesh is round in too fine steps; simplify it, or use graspdb teach OBJECT --mesh FILE");
  const planes = planesOf(faces);
  const corners = new Set<Vector3>();
  const facets: HullFacet[] = Array.from({ length: planes.reduce((most, each) => Math.max(most, each), 0) + 1 }, () => ({ normal: new Vector3(), offset: 0, triangles: [], edges: [] }));
  const place = new Map(faces.map((face, i) => [face, i]));
  faces.forEach((face, i) => {
    const facet = facets[planes[i]!]!;
    const edges = edgesOf(face);
    const [a, b, c] = edges.map((edge) => edge.head().point) as [Vector3, Vector3, Vector3];
    facet.normal.copy(face.normal);
    facet.triangles.push([a, b, c]);
    [a, b, c].forEach((each) => corners.add(each));
    for (const edge of edges) {
      const neighbor = planes[place.get(edge.twin.face)!]!;
      if (neighbor !== planes[i]) facet.edges.push({ from: edge.tail().point, to: edge.head().point, neighbor });
    }
  });
  facets.forEach(fitPlane);
  const out = { points: [...corners], facets };
  if (massOfHull(out).volume < minVolume * diameterOf(out) ** 3) throw new Error(flatText);
  return out;
}

// Volume and centre of mass of the hull as a solid.
export function massOfHull(hull: ConvexHull): { volume: number; center: Vector3 } {
  const apex = hull.points.reduce((sum, each) => sum.add(each), new Vector3()).divideScalar(hull.points.length);
  const moment = new Vector3();
  let volume = 0;
  for (const { triangles } of hull.facets) {
    for (const corners of triangles) {
      const [a, b, c] = corners.map((each) => each.clone().sub(apex)) as [Vector3, Vector3, Vector3];
      const part = a.dot(b.clone().cross(c)) / 6;
      volume += part;
      moment.addScaledVector(a.add(b).add(c), part / 4);
    }
  }
  return { volume, center: apex.addScaledVector(moment, 1 / Math.max(volume, 1e-30)) };
}

const maxPairs = 2000;

// The largest distance between two points; with many points along 1000 directions, at most 0.2 % too small.
export function diameterOf(hull: ConvexHull): number {
  const { points } = hull;
  let largest = 0;
  if (points.length <= maxPairs) {
    points.forEach((a, i) => {
      for (let j = 0; j < i; ++j) largest = Math.max(largest, a.distanceToSquared(points[j]!));
    });
    return Math.sqrt(largest);
  }
  const count = 1000;
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * i + 1) / count;
    const turn = i * Math.PI * (3 - Math.sqrt(5));
    const r = Math.sqrt(1 - z * z);
    const direction = new Vector3(r * Math.cos(turn), r * Math.sin(turn), z);
    let [low, high] = [points[0]!, points[0]!];
    for (const each of points) {
      if (direction.dot(each) < direction.dot(low)) low = each;
      if (direction.dot(each) > direction.dot(high)) high = each;
    }
    largest = Math.max(largest, low.distanceTo(high));
  }
  return largest;
}
