// Meshes in dropped files: PLY, OBJ, and STL by the loader of three.js. A file may have any bytes, so that what the loader takes for
// granted is checked before.
import { Vector3 } from "three";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { readObjMesh } from "./obj_mesh";
import { readPlyMesh } from "./ply_mesh";
import type { PolygonMesh } from "./polygons";
import { boundsOf, opposedShare, turnOutwards, type TriangleMesh } from "./triangle_mesh";

export const maxMeshBytes = 32 << 20;
const maxTriangles = 500_000;
const maxOpposedShare = 0.005;  // a scan may have a few

export interface MeshFile {
  mesh: TriangleMesh;      // in the unit of the file
  stated: string;          // the unit that a comment names, as in `lengthUnits`; empty: none
  isSided: boolean;        // false: many neighbouring triangles turn against each other, so that its outside is not known
}

// In metres; the usual ones first.
export const lengthUnits: Record<string, number> = { mm: 0.001, m: 1, cm: 0.01, inch: 0.0254 };
export const isMeshName = (name: string): boolean => /\.(stl|obj|ply)$/i.test(name);

const smallestSide = 0.005;  // m, as graspdb teach
const largestSide = 0.6;

// The units in which a mesh that is `side` units large has the size of a part.
export const fittingUnits = (side: number): string[] =>
  Object.keys(lengthUnits).filter((unit) => side * lengthUnits[unit]! >= smallestSide && side * lengthUnits[unit]! <= largestSide);

export function largestSideOf(mesh: TriangleMesh): number {
  const size = boundsOf(mesh).getSize(new Vector3());
  return Math.max(size.x, size.y, size.z);
}

const textOf = (bytes: Uint8Array): string => new TextDecoder("latin1").decode(bytes);

// "# File units = millimeters", "comment UNITS: mm".
function statedUnit(lines: string): string {
  const found = /\bunits?\s*[:=]\s*"?([a-z]+)/i.exec(lines)?.[1]?.toLowerCase() ?? "";
  const names: [RegExp, string][] = [[/^(mm|millimet(er|re)s?)$/, "mm"], [/^(cm|centimet(er|re)s?)$/, "cm"], [/^(m|met(er|re)s?)$/, "m"], [/^(in|inch|inches)$/, "inch"]];
  return names.find(([pattern]) => pattern.test(found))?.[1] ?? "";
}

function checkCount(triangles: number): void {
  if (triangles > maxTriangles) throw new Error(`it has more than ${maxTriangles.toLocaleString("en")} triangles; simplify it, or use graspdb teach OBJECT --mesh FILE`);
}

function readStlMesh(bytes: Uint8Array): PolygonMesh {
  if (bytes.length < 84) throw new Error("it is too short for an STL file");
  const triangles = new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);
  const isText = bytes.length !== 84 + 50 * triangles;
  if (isText) {
    const text = textOf(bytes);
    const end = text.lastIndexOf("endsolid");
    if (!text.trimStart().startsWith("solid")) throw new Error("its length is not that of its number of triangles");
    // The loader looks for the ends again and again where they are missing.
    if (end < 0 || text.length - end > 1024) throw new Error("the text of the STL file is cut short");
    if (text.split("endfacet").length !== text.split(/facet\s+normal/).length) throw new Error("a facet of the STL file has no end");
  }
  // An ArrayBuffer of the bytes alone.
  const geometry = new STLLoader().parse(bytes.slice().buffer as ArrayBuffer);
  const vertices = geometry.attributes.position!.array as Float32Array;
  geometry.dispose();
  return { vertices, triangles: Array.from({ length: vertices.length / 3 }, (_, i) => i), comments: textOf(bytes.subarray(0, 80)) };
}

// Vertices of equal coordinates as one, and those of no triangle left out.
function welded({ vertices, triangles }: PolygonMesh): TriangleMesh {
  if (triangles.length === 0) throw new Error("it has no triangles");
  checkCount(triangles.length / 3);
  const out: TriangleMesh = { vertices: new Float32Array(), triangles: new Uint32Array(triangles.length) };
  const kept: number[] = [];
  const numbers = new Map<string, number>();
  triangles.forEach((from, at) => {
    const [x, y, z] = [0, 1, 2].map((k) => vertices[3 * from + k]! + 0) as [number, number, number];  // -0 is 0
    if (!Number.isFinite(x + y + z)) throw new Error("a vertex is not finite");
    const key = `${x},${y},${z}`;
    let number = numbers.get(key);
    if (number === undefined) {
      number = kept.length / 3;
      kept.push(x, y, z);
      numbers.set(key, number);
    }
    out.triangles[at] = number;
  });
  out.vertices = new Float32Array(kept);
  return out;
}

// Steps of single precision at the farthest coordinate that the largest side must have.
function checkPrecision(mesh: TriangleMesh): void {
  const { min, max } = boundsOf(mesh);
  const farthest = Math.max(...[...min.toArray(), ...max.toArray()].map(Math.abs));
  if (largestSideOf(mesh) < 1e4 * farthest * 1.2e-7) throw new Error("it is so far from its origin that single precision changes its shape; move it to its origin");
}

// `name`: of the file, which has its format.
export function readMesh(name: string, bytes: Uint8Array): MeshFile {
  if (bytes.length > maxMeshBytes) throw new Error(`${name} is larger than ${maxMeshBytes >> 20} MiB`);
  try {
    const read = /\.ply$/i.test(name) ? readPlyMesh : /\.stl$/i.test(name) ? readStlMesh : readObjMesh;
    const polygons = read(bytes, checkCount);
    const mesh = welded(polygons);
    checkPrecision(mesh);
    turnOutwards(mesh);
    return { mesh, stated: statedUnit(polygons.comments), isSided: opposedShare(mesh) <= maxOpposedShare };
  } catch (error) {
    const text = error instanceof Error && error.constructor === Error ? error.message : `it cannot be read (${String(error)}); export it again as PLY, OBJ or STL`;
    throw new Error(`${name} is no usable mesh: ${text}`);
  }
}
