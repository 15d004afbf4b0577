// How an object comes to rest on a table when it is dropped without a bounce: as client/teaching/mesh/resting.cc computes it, after
// K. Goldberg and others, "Part pose statistics: estimators and experiments", 1999.
import { Vector3 } from "three";
import { massOfHull, type ConvexHull, type HullEdge } from "./convex_hull";
import { forEachTriangle, solidOf, type TriangleMesh } from "./triangle_mesh";

const openShare = 0.01;    // of the area: smaller holes do not open a solid
const minVolume = 1e-3;    // of the hull's volume: outside of these the mesh is no solid
const maxVolume = 1.01;
const minTip = 0.017455;   // the tangent of one degree: less is not stable

// `isOfHull`: the surface is not closed.
export interface MassCenter { center: Vector3; isOfHull: boolean }

const isInside = (hull: ConvexHull, p: Vector3): boolean => hull.facets.every((facet) => facet.normal.dot(p) < facet.offset);

export function centerOfMass(mesh: TriangleMesh, hull: ConvexHull): MassCenter {
  const whole = massOfHull(hull);
  const open = new Vector3();
  let area = 0;
  let volume = 0;
  forEachTriangle(mesh, (a, b, c) => {
    a.sub(whole.center);
    b.sub(whole.center);
    c.sub(whole.center);
    volume += a.dot(b.clone().cross(c)) / 6;
    const twice = b.sub(a).cross(c.sub(a));
    open.addScaledVector(twice, 0.5);
    area += twice.length() / 2;
  });
  const share = Math.abs(volume) / whole.volume;
  const solid = solidOf(mesh);
  const isSolid = solid && open.length() <= openShare * area && share >= minVolume && share <= maxVolume && isInside(hull, solid.center);
  return isSolid ? { center: solid.center, isOfHull: false } : { center: whole.center, isOfHull: true };
}

// Share of the sphere around `eye` that a triangle covers (A. van Oosterom and J. Strackee, 1983).
function solidAngle(eye: Vector3, corners: [Vector3, Vector3, Vector3]): number {
  const [a, b, c] = corners.map((each) => each.clone().sub(eye)) as [Vector3, Vector3, Vector3];
  const [la, lb, lc] = [a.length(), b.length(), c.length()];
  const over = a.dot(b.clone().cross(c));
  return 2 * Math.atan2(over, la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
}

// A hull with the height of the centre of mass over each facet.
class Landscape {
  readonly heights: number[];

  constructor(private readonly hull: ConvexHull, private readonly center: Vector3) {
    this.heights = hull.facets.map((facet) => facet.offset - facet.normal.dot(center));
  }

  solidAngleOf(facet: number): number {
    return this.hull.facets[facet]!.triangles.reduce((sum, each) => sum + solidAngle(this.center, each), 0);
  }

  // The facet to which it rolls from `facet`; `facet` itself if it rests there.
  next(facet: number): number {
    const { normal, edges } = this.hull.facets[facet]!;
    const height = this.heights[facet]!;
    const foot = this.center.clone().addScaledVector(normal, height);
    let nearest = Infinity;
    let next = facet;
    for (const edge of edges) {
      const along = edge.to.clone().sub(edge.from);
      const arm = foot.clone().sub(edge.from);
      const inside = normal.clone().cross(along).normalize().dot(arm);
      if (inside >= minTip * height || this.heights[edge.neighbor]! >= height) continue;
      const t = Math.min(1, Math.max(0, along.dot(arm) / along.lengthSq()));
      const distance = edge.from.clone().addScaledVector(along, t).distanceTo(foot);
      if (distance >= nearest) continue;
      nearest = distance;
      next = edge.neighbor;
    }
    return next;
  }

  // The maximum height while it rolls over an edge.
  passOver(facet: number, edge: HullEdge): number {
    const higher = Math.max(this.heights[facet]!, this.heights[edge.neighbor]!);
    const along = edge.to.clone().sub(edge.from).normalize();
    const arm = edge.from.clone().sub(this.center);
    arm.addScaledVector(along, -along.dot(arm));
    const [from, to] = [this.hull.facets[facet]!.normal, this.hull.facets[edge.neighbor]!.normal];
    const between = from.clone().cross(arm).dot(from.clone().cross(to)) >= 0 && to.clone().cross(arm).dot(to.clone().cross(from)) >= 0 &&
      arm.dot(from.clone().add(to)) > 0;
    return between ? arm.length() : higher;
  }
}

// Facets joined from the lowest pass upwards, for as long as a basin is shallower than the lift. Gives the basin of a facet.
function basinsOf(hull: ConvexHull, land: Landscape, rollLift: number): (facet: number) => number {
  const parent = hull.facets.map((_, i) => i);
  const of = (facet: number): number => {
    while (parent[facet] !== facet) facet = parent[facet]!;
    return facet;
  };
  const passes: { height: number; a: number; b: number }[] = [];
  hull.facets.forEach(({ edges }, a) => edges.forEach((edge) => {
    if (edge.neighbor > a) passes.push({ height: land.passOver(a, edge), a, b: edge.neighbor });
  }));
  passes.sort((one, other) => one.height - other.height);
  for (const pass of passes) {
    let [a, b] = [of(pass.a), of(pass.b)];
    if (a === b) continue;
    if (land.heights[b]! < land.heights[a]!) [a, b] = [b, a];
    if (pass.height - land.heights[b]! <= rollLift) parent[b] = a;
  }
  return of;
}

// A facet on which the object rests. `down`: mesh frame, of length one. Facets between which it rolls with nearly no lift have the
// same basin.
export interface RestingFacet { down: Vector3; probability: number; basin: number }

// The most probable first. Throws where the centre is outside of the hull.
export function restingFacets(hull: ConvexHull, center: Vector3, rollLift: number): RestingFacet[] {
  if (!isInside(hull, center)) throw new Error("the centre of mass lies outside of the hull; close the surface of the mesh");
  const land = new Landscape(hull, center);
  const basinOf = basinsOf(hull, land, rollLift);
  const next = hull.facets.map((_, i) => land.next(i));
  const probability = hull.facets.map(() => 0);
  hull.facets.forEach((_, facet) => {
    let at = facet;
    while (next[at] !== at) at = next[at]!;
    probability[at]! += land.solidAngleOf(facet) / (4 * Math.PI);
  });
  return hull.facets.map(({ normal }, i) => ({ down: normal, probability: probability[i]!, basin: basinOf(i) }))
    .filter((each) => each.probability > 0).sort((a, b) => b.probability - a.probability);
}

const cross = (a: [number, number], b: [number, number]): number => a[0] * b[1] - a[1] * b[0];
const minus = (a: [number, number], b: [number, number]): [number, number] => [a[0] - b[0], a[1] - b[1]];

// The convex polygon around points, counter-clockwise (A. M. Andrew, 1979).
function polygonOf(points: [number, number][]): [number, number][] {
  points.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const out: [number, number][] = [];
  for (let pass = 0; pass < 2; ++pass) {
    const begin = out.length;
    for (const p of points) {
      while (out.length >= begin + 2 && cross(minus(out.at(-1)!, out.at(-2)!), minus(p, out.at(-2)!)) <= 0) out.pop();
      out.push(p);
    }
    out.pop();
    points.reverse();
  }
  return out;
}

// The tilt of the table at which an object that rests with `down` tips over, rad. `touching`: corners so near to the table carry it.
export function tipAngle(hull: ConvexHull, center: Vector3, down: Vector3, touching: number): number {
  const x = (Math.abs(down.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0)).cross(down).normalize();
  const y = down.clone().cross(x);
  const arms = hull.points.map((each) => each.clone().sub(center));
  const lowest = arms.reduce((most, each) => Math.max(most, down.dot(each)), -Infinity);
  const polygon = polygonOf(arms.filter((each) => down.dot(each) >= lowest - touching).map((each) => [x.dot(each), y.dot(each)]));
  if (polygon.length < 3) return 0;
  let margin = Infinity;
  polygon.forEach((corner, i) => {
    const along = minus(polygon[(i + 1) % polygon.length]!, corner);
    const length = Math.hypot(...along);
    margin = Math.min(margin, cross([along[0] / length, along[1] / length], [-corner[0], -corner[1]]));
  });
  return Math.atan2(margin, lowest);
}
