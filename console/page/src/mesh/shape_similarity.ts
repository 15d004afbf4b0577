// Similarity of two surfaces on the table, and of one to itself turned about the vertical: as recognition/models/shape_similarity.cc
// finds it. Metres and radians.
import { SurfaceModel, type OrientedCloud } from "./surface_model";

const alikeShare = 0.02;  // of the diameter
const minAlike = 0.0025;
const maxAlike = 0.009;
const gapShare = 0.95;
const far = 0.02;         // distance of points outside of a model
const iterations = 12;
const maxFold = 12;
const anyTurns = 36;      // tried for a round object
const pairTurns = 24;     // tried for two objects
const sameSize = 0.9;     // of the radius; others are not compared

// A move over the table: a turn about the vertical, then a shift.
interface Slide { turn: number; x: number; y: number }

// Surfaces with a smaller gap are one shape to a depth camera.
export const alike = (model: SurfaceModel): number => Math.min(maxAlike, Math.max(minAlike, alikeShare * 2 * model.radius));
const nearlyAlike = (model: SurfaceModel): number => 2 * alike(model);

// About the vertical through the centre of `a`, which goes to that of `b`.
function turnedOnto(a: SurfaceModel, b: SurfaceModel, turn: number): Slide {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return { turn, x: b.center[0] - (c * a.center[0] - s * a.center[1]), y: b.center[1] - (s * a.center[0] + c * a.center[1]) };
}

// The solution of a symmetric system of three equations, by Cramer's rule.
function solved(m: number[], r: number[]): [number, number, number] {
  const [a, b, c, d, e, f] = m as [number, number, number, number, number, number];  // xx, xy, xt, yy, yt, tt
  const [A, B, C] = [d * f - e * e, c * e - b * f, b * e - c * d];
  const det = a * A + b * B + c * C;
  return [
    (A * r[0]! + B * r[1]! + C * r[2]!) / det,
    (B * r[0]! + (a * f - c * c) * r[1]! + (b * c - a * e) * r[2]!) / det,
    (C * r[0]! + (b * c - a * e) * r[1]! + (a * d - b * b) * r[2]!) / det,
  ];
}

// Gauss and Newton over the table, on distances to tangent planes; without `mayTurn` the turn stays.
function slideOnto(a: SurfaceModel, b: SurfaceModel, start: Slide, mayTurn: boolean): Slide {
  let slide = start;
  const { points, normals } = a.coarse;
  for (let iteration = 0; iteration < iterations; ++iteration) {
    const [c, s] = [Math.cos(slide.turn), Math.sin(slide.turn)];
    const cx = c * a.center[0] - s * a.center[1] + slide.x;
    const cy = s * a.center[0] + c * a.center[1] + slide.y;
    const h = [1e-9, 0, 0, 1e-9, 0, 1e-9];
    const g = [0, 0, 0];
    for (let at = 0; at < points.length; at += 3) {
      const x = c * points[at]! - s * points[at + 1]! + slide.x;
      const y = s * points[at]! + c * points[at + 1]! + slide.y;
      const z = points[at + 2]!;
      const i = b.nearest(x, y, z);
      if (i < 0) continue;
      const [nx, ny, nz] = [b.fine.normals[3 * i]!, b.fine.normals[3 * i + 1]!, b.fine.normals[3 * i + 2]!];
      const facing = nx * (c * normals[at]! - s * normals[at + 1]!) + ny * (s * normals[at]! + c * normals[at + 1]!) + nz * normals[at + 2]!;
      if (facing < 0.5) continue;
      const t = mayTurn ? (x - cx) * ny - (y - cy) * nx : 0;
      const residual = (b.fine.points[3 * i]! - x) * nx + (b.fine.points[3 * i + 1]! - y) * ny + (b.fine.points[3 * i + 2]! - z) * nz;
      h[0]! += nx * nx;
      h[1]! += nx * ny;
      h[2]! += nx * t;
      h[3]! += ny * ny;
      h[4]! += ny * t;
      h[5]! += t * t;
      g[0]! += residual * nx;
      g[1]! += residual * ny;
      g[2]! += residual * t;
    }
    if (!mayTurn) h[5] = 1;
    const [dx, dy, dt] = solved(h, g);
    // About the centre of `a` where it is now.
    const turn = slide.turn + dt;
    const [nc, ns] = [Math.cos(turn), Math.sin(turn)];
    slide = { turn, x: cx + dx - (nc * a.center[0] - ns * a.center[1]), y: cy + dy - (ns * a.center[0] + nc * a.center[1]) };
  }
  return slide;
}

function addDistances(from: OrientedCloud, to: SurfaceModel, slide: Slide, distances: number[]): void {
  const [c, s] = [Math.cos(slide.turn), Math.sin(slide.turn)];
  const { points } = from;
  for (let at = 0; at < points.length; at += 3) {
    const x = c * points[at]! - s * points[at + 1]! + slide.x;
    const y = s * points[at]! + c * points[at + 1]! + slide.y;
    distances.push(Math.min(far, to.distanceTo(x, y, points[at + 2]!)));
  }
}

function inverse({ turn, x, y }: Slide): Slide {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return { turn: -turn, x: -(c * x + s * y), y: s * x - c * y };
}

// The distance within which 95 % of the points of either surface are from the other one.
function gapOf(a: SurfaceModel, b: SurfaceModel, slide: Slide): number {
  const distances: number[] = [];
  addDistances(a.coarse, b, slide, distances);
  addDistances(b.coarse, a, inverse(slide), distances);
  distances.sort((one, other) => one - other);
  return distances[Math.floor(gapShare * (distances.length - 1))] ?? far;
}

// The largest gap of the turns by `count`-ths of a whole one; gives up beyond `limit`.
function gapOfTurns(model: SurfaceModel, count: number, limit: number): number {
  let worst = 0;
  for (let k = 1; k < count && worst <= limit; ++k) {
    worst = Math.max(worst, gapOf(model, model, slideOnto(model, model, turnedOnto(model, model, (2 * Math.PI * k) / count), false)));
  }
  return worst;
}

// `order`: 1 none, n for n-fold, 0 for any turn; `isNearly`: a camera with little noise may distinguish the turns.
export interface FoundSymmetry { order: number; isNearly: boolean }

export function findSymmetry(model: SurfaceModel): FoundSymmetry {
  for (const isNearly of [false, true]) {
    const limit = isNearly ? nearlyAlike(model) : alike(model);
    if (gapOfTurns(model, anyTurns, limit) <= limit) return { order: 0, isNearly };
    for (let order = maxFold; order > 1; --order) {
      if (gapOfTurns(model, order, limit) <= limit) return { order, isNearly };
    }
  }
  return { order: 1, isNearly: false };
}

// The gap in the turn that fits best; Infinity where they differ by more than what is nearly alike.
export function similarity(a: SurfaceModel, b: SurfaceModel): number {
  if (Math.min(a.radius, b.radius) < sameSize * Math.max(a.radius, b.radius)) return Infinity;
  const limit = Math.max(nearlyAlike(a), nearlyAlike(b));
  if (Math.abs(a.center[2] - b.center[2]) > limit) return Infinity;
  let best = Infinity;
  for (let k = 0; k < pairTurns; ++k) {
    const slide = slideOnto(a, b, turnedOnto(a, b, (2 * Math.PI * k) / pairTurns), true);
    const gap = gapOf(a, b, slide);
    if (gap <= limit) best = Math.min(best, gap);
  }
  return best;
}
