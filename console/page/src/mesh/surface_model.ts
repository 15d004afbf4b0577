// The surface of a mesh as recognition models it, to compare its stable poses: as recognition/models/surface_model.cc makes
// it of samples. Metres.
import { Matrix4 } from "three";
import { areaOf, forEachTriangle, type TriangleMesh } from "./triangle_mesh";

// x, y, z of points, and of their normals.
export interface OrientedCloud { points: Float64Array; normals: Float64Array }

const surfaceSpacing = 0.003;
const cellSize = 0.0025;        // of the fusion
const sameSide = 0.3;           // cosine between normals
const sameFace = 0.9;
const weightDeviation = 0.003;  // of neighbours, onto whose surface a point is projected
const weightReach = 2 * weightDeviation;
const minSpacing = 0.0015;
const coarsePoints = 350;
const reach = 0.021;            // how far from the surface distances are measured
const maxCells = 2_000_000;

const sizeOf = (cloud: OrientedCloud): number => cloud.points.length / 3;
const dot = (a: ArrayLike<number>, i: number, b: ArrayLike<number>, j: number): number => a[i]! * b[j]! + a[i + 1]! * b[j + 1]! + a[i + 2]! * b[j + 2]!;
const squared = (a: ArrayLike<number>, i: number, b: ArrayLike<number>, j: number): number =>
  (a[i]! - b[j]!) ** 2 + (a[i + 1]! - b[j + 1]!) ** 2 + (a[i + 2]! - b[j + 2]!) ** 2;

// The same numbers in [0, 1) each time (Mulberry32).
export function randomNumbers(seed: number): () => number {
  let state = seed | 0;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

// Points uniform by area, with the normals of their triangles.
function sampled(mesh: TriangleMesh, count: number): OrientedCloud {
  const total = areaOf(mesh);
  const random = randomNumbers(1);
  const out = { points: new Float64Array(3 * count), normals: new Float64Array(3 * count) };
  // Ascending places along the area, one at random in each of `count` equal pieces.
  let size = 0;
  let area = 0;
  forEachTriangle(mesh, (a, b, c) => {
    const across = b.clone().sub(a).cross(c.clone().sub(a));
    area += across.length() / 2;
    across.normalize();
    for (; size < count && ((size + 0.5) / count) * total <= area; ++size) {
      const r = Math.sqrt(random());
      const s = random();
      a.clone().multiplyScalar(1 - r).addScaledVector(b, r * (1 - s)).addScaledVector(c, r * s).toArray(out.points, 3 * size);
      across.toArray(out.normals, 3 * size);
    }
  });
  return { points: out.points.subarray(0, 3 * size), normals: out.normals.subarray(0, 3 * size) };
}

// Cells of points for neighbour searches.
class CellMap {
  private readonly cells = new Map<number, number[]>();

  constructor(points: Float64Array, private readonly cell: number) {
    for (let i = 0; 3 * i < points.length; ++i) this.listAt(points, 3 * i).push(i);
  }

  private static key(x: number, y: number, z: number): number {
    return (x + 0x8000) * 0x100000000 + (y + 0x8000) * 0x10000 + (z + 0x8000);
  }

  private listAt(p: ArrayLike<number>, at: number): number[] {
    const key = CellMap.key(Math.floor(p[at]! / this.cell), Math.floor(p[at + 1]! / this.cell), Math.floor(p[at + 2]! / this.cell));
    let list = this.cells.get(key);
    if (!list) this.cells.set(key, (list = []));
    return list;
  }

  // Calls `use` with points in the cells up to `layers` away.
  forEachNear(x: number, y: number, z: number, layers: number, use: (i: number) => void): void {
    const [cx, cy, cz] = [Math.floor(x / this.cell), Math.floor(y / this.cell), Math.floor(z / this.cell)];
    for (let dx = -layers; dx <= layers; ++dx) {
      for (let dy = -layers; dy <= layers; ++dy) {
        for (let dz = -layers; dz <= layers; ++dz) {
          const list = this.cells.get(CellMap.key(cx + dx, cy + dy, cz + dz));
          if (list) for (const i of list) use(i);
        }
      }
    }
  }
}

// A grid of cells, each with the point nearest to its middle: as recognition/points/nearest_grid.cc.
class NearestCells {
  private readonly low: number[];
  private readonly sizes: number[];
  private readonly cell: number;
  private readonly nearest: Int32Array;

  // `low`, `high`: of the points; a cell has a point that is up to `limit` from it.
  constructor(points: Float64Array, low: number[], high: number[], smallest: number, limit: number) {
    this.low = low.map((each) => each - limit);
    const sides = high.map((each, k) => each + limit - this.low[k]!);
    this.cell = Math.max(smallest, Math.cbrt((sides[0]! * sides[1]! * sides[2]!) / maxCells));
    this.sizes = sides.map((each) => Math.ceil(each / this.cell) + 1);
    const size = this.sizes[0]! * this.sizes[1]! * this.sizes[2]!;
    this.nearest = new Int32Array(size).fill(-1);
    const best = new Float32Array(size).fill((limit + 0.87 * this.cell) ** 2);
    const layers = Math.ceil(limit / this.cell + 0.87);
    for (let i = 0; 3 * i < points.length; ++i) this.add(points, i, layers, best);
  }

  private add(points: Float64Array, i: number, layers: number, best: Float32Array): void {
    const [x, y, z] = [0, 1, 2].map((k) => (points[3 * i + k]! - this.low[k]!) / this.cell) as [number, number, number];
    const [nx, ny, nz] = this.sizes as [number, number, number];
    const scale = this.cell * this.cell;
    for (let iz = Math.max(0, Math.floor(z) - layers); iz <= Math.min(nz - 1, Math.floor(z) + layers); ++iz) {
      for (let iy = Math.max(0, Math.floor(y) - layers); iy <= Math.min(ny - 1, Math.floor(y) + layers); ++iy) {
        const flat = (iz + 0.5 - z) ** 2 + (iy + 0.5 - y) ** 2;
        const row = (iz * ny + iy) * nx;
        for (let ix = Math.max(0, Math.floor(x) - layers); ix <= Math.min(nx - 1, Math.floor(x) + layers); ++ix) {
          const distance = scale * (flat + (ix + 0.5 - x) ** 2);
          if (distance >= best[row + ix]!) continue;
          best[row + ix] = distance;
          this.nearest[row + ix] = i;
        }
      }
    }
  }

  at(x: number, y: number, z: number): number {
    const ix = Math.floor((x - this.low[0]!) / this.cell);
    const iy = Math.floor((y - this.low[1]!) / this.cell);
    const iz = Math.floor((z - this.low[2]!) / this.cell);
    if (!(ix >= 0 && iy >= 0 && iz >= 0 && ix < this.sizes[0]! && iy < this.sizes[1]! && iz < this.sizes[2]!)) return -1;
    return this.nearest[(iz * this.sizes[1]! + iy) * this.sizes[0]! + ix]!;
  }
}

// The means of the points in each cell, those of opposite sides apart.
function meansOf(cloud: OrientedCloud): { cloud: OrientedCloud; counts: number[] } {
  interface Surfel { point: number[]; normal: number[]; count: number }
  const cells = new Map<string, Surfel[]>();
  const surfels: Surfel[] = [];
  for (let at = 0; at < cloud.points.length; at += 3) {
    const key = [0, 1, 2].map((k) => Math.floor(cloud.points[at + k]! / cellSize)).join(",");
    const here = cells.get(key) ?? [];
    cells.set(key, here);
    let surfel = here.find((each) => dot(each.normal, 0, cloud.normals, at) > sameSide * Math.hypot(...each.normal));
    if (!surfel) {
      surfel = { point: [0, 0, 0], normal: [0, 0, 0], count: 0 };
      here.push(surfel);
      surfels.push(surfel);
    }
    for (let k = 0; k < 3; ++k) {
      surfel.point[k]! += cloud.points[at + k]!;
      surfel.normal[k]! += cloud.normals[at + k]!;
    }
    ++surfel.count;
  }
  const kept = surfels.filter((each) => Math.hypot(...each.normal) > 1e-6);
  return {
    cloud: {
      points: new Float64Array(kept.flatMap((each) => each.point.map((value) => value / each.count))),
      normals: new Float64Array(kept.flatMap((each) => each.normal.map((value) => value / Math.hypot(...each.normal)))),
    },
    counts: kept.map((each) => each.count),
  };
}

// The means, projected onto the surface of their neighbours.
function laid({ cloud, counts }: { cloud: OrientedCloud; counts: number[] }): OrientedCloud {
  const { points, normals } = cloud;
  const map = new CellMap(points, weightReach);
  const out = { points: points.slice(), normals: normals.slice() };
  for (let at = 0; at < points.length; at += 3) {
    let [off, weights, dx, dy, dz] = [0, 0, 0, 0, 0];
    map.forEachNear(points[at]!, points[at + 1]!, points[at + 2]!, 1, (i) => {
      const distance = squared(points, 3 * i, points, at);
      if (distance > weightReach ** 2 || dot(normals, 3 * i, normals, at) < sameFace) return;
      const weight = counts[i]! * Math.exp(-distance / (2 * weightDeviation ** 2));
      const mean = [0, 1, 2].map((k) => normals[3 * i + k]! + normals[at + k]!);
      const to = [0, 1, 2].map((k) => points[3 * i + k]! - points[at + k]!);
      off += (weight * dot(to, 0, mean, 0)) / Math.hypot(...mean);
      dx += weight * normals[3 * i]!;
      dy += weight * normals[3 * i + 1]!;
      dz += weight * normals[3 * i + 2]!;
      weights += weight;
    });
    const length = Math.hypot(dx, dy, dz);
    for (let k = 0; k < 3; ++k) {
      out.points[at + k]! += (off / weights) * normals[at + k]!;
      out.normals[at + k] = [dx, dy, dz][k]! / length;
    }
  }
  return out;
}

function withoutDoubles(cloud: OrientedCloud): OrientedCloud {
  const map = new CellMap(cloud.points, minSpacing);
  const isDouble = new Uint8Array(sizeOf(cloud));
  const kept: number[] = [];
  for (let i = 0; i < isDouble.length; ++i) {
    if (isDouble[i]) continue;
    kept.push(i);
    map.forEachNear(cloud.points[3 * i]!, cloud.points[3 * i + 1]!, cloud.points[3 * i + 2]!, 1, (j) => {
      if (squared(cloud.points, 3 * i, cloud.points, 3 * j) < minSpacing ** 2 && dot(cloud.normals, 3 * i, cloud.normals, 3 * j) > sameSide) isDouble[j] = 1;
    });
  }
  return chosen(cloud, kept);
}

const chosen = (cloud: OrientedCloud, kept: number[]): OrientedCloud => ({
  points: new Float64Array(kept.flatMap((i) => [...cloud.points.subarray(3 * i, 3 * i + 3)])),
  normals: new Float64Array(kept.flatMap((i) => [...cloud.normals.subarray(3 * i, 3 * i + 3)])),
});

// Points all over the surface of a mesh in metres.
export function surfaceOf(mesh: TriangleMesh): OrientedCloud {
  const wanted = areaOf(mesh) / (surfaceSpacing / 2) ** 2;
  const count = Math.floor(Math.min(60_000, Math.max(2000, wanted)));
  return withoutDoubles(laid(meansOf(sampled(mesh, count))));
}

export function movedCloud(cloud: OrientedCloud, matrix: Matrix4): OrientedCloud {
  const out = { points: new Float64Array(cloud.points.length), normals: new Float64Array(cloud.points.length) };
  const e = matrix.elements;
  for (let at = 0; at < cloud.points.length; at += 3) {
    const [p, n] = [cloud.points, cloud.normals];
    for (let k = 0; k < 3; ++k) {
      out.points[at + k] = e[k]! * p[at]! + e[4 + k]! * p[at + 1]! + e[8 + k]! * p[at + 2]! + e[12 + k]!;
      out.normals[at + k] = e[k]! * n[at]! + e[4 + k]! * n[at + 1]! + e[8 + k]! * n[at + 2]!;
    }
  }
  return out;
}

// One point of each cell, and of each side that the surface has there.
function thinned(cloud: OrientedCloud): OrientedCloud {
  const spacing = cellSize * Math.max(1, Math.sqrt(sizeOf(cloud) / coarsePoints));
  const taken = new Map<string, number[]>();
  const kept: number[] = [];
  for (let i = 0; i < sizeOf(cloud); ++i) {
    const key = [0, 1, 2].map((k) => Math.floor(cloud.points[3 * i + k]! / spacing)).join(",");
    const here = taken.get(key) ?? [];
    taken.set(key, here);
    if (here.some((j) => dot(cloud.normals, 3 * i, cloud.normals, 3 * j) > sameSide)) continue;
    here.push(i);
    kept.push(i);
  }
  return chosen(cloud, kept);
}

// A surface on the table.
export class SurfaceModel {
  readonly coarse: OrientedCloud;
  readonly center: [number, number, number];  // of the bounding box
  readonly radius: number;                    // around the centre
  private readonly near: NearestCells;
  private readonly distant: NearestCells;

  constructor(readonly fine: OrientedCloud) {
    this.coarse = thinned(fine);
    const { points } = fine;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let at = 0; at < points.length; ++at) {
      low[at % 3] = Math.min(low[at % 3]!, points[at]!);
      high[at % 3] = Math.max(high[at % 3]!, points[at]!);
    }
    this.center = [0, 1, 2].map((k) => (low[k]! + high[k]!) / 2) as [number, number, number];
    let radius = 0;
    for (let at = 0; at < points.length; at += 3) radius = Math.max(radius, squared(points, at, this.center, 0));
    this.radius = Math.sqrt(radius);
    this.near = new NearestCells(points, low, high, surfaceSpacing, 2 * surfaceSpacing);
    this.distant = new NearestCells(points, low, high, 2 * surfaceSpacing, reach);
  }

  // A point near to the nearest one, up to a cell's diagonal farther; -1: none within reach.
  nearest(x: number, y: number, z: number): number {
    const found = this.near.at(x, y, z);
    return found >= 0 ? found : this.distant.at(x, y, z);
  }

  // Across the surface, and along it where it has ended; 1 m where there is none near.
  distanceTo(x: number, y: number, z: number): number {
    const i = this.nearest(x, y, z);
    if (i < 0) return 1;
    const { points, normals } = this.fine;
    const d = [x - points[3 * i]!, y - points[3 * i + 1]!, z - points[3 * i + 2]!];
    const across = dot(d, 0, normals, 3 * i);
    const along = Math.sqrt(Math.max(0, dot(d, 0, d, 0) - across * across));
    return Math.hypot(across, Math.max(0, along - surfaceSpacing));
  }
}
