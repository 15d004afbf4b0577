// Meshes in dropped files: PLY, and STL and OBJ by the loaders of three.js. A file may have any bytes, so that what the loaders take for
// granted is checked before.
import { BufferAttribute, BufferGeometry, Mesh, Vector3 } from "three";
import { OBJLoader } from "three/examples/jsm/loaders/OBJLoader.js";
import { STLLoader } from "three/examples/jsm/loaders/STLLoader.js";
import { readPlyMesh } from "./ply_mesh";
import { boundsOf, opposedShare, turnOutwards, type TriangleMesh } from "./triangle_mesh";

export const maxMeshBytes = 32 << 20;
const maxTriangles = 500_000;
const maxOpposedShare = 0.005;  // a scan may have a few
const maxHeaderBytes = 64 * 1024;

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

// An ArrayBuffer of the bytes alone.
const bufferOf = (bytes: Uint8Array): ArrayBuffer => bytes.slice().buffer as ArrayBuffer;

function checkCount(triangles: number): void {
  if (triangles > maxTriangles) throw new Error(`it has more than ${maxTriangles.toLocaleString("en")} triangles; simplify it, or use graspdb teach OBJECT --mesh FILE`);
}

function fromPly(bytes: Uint8Array): { geometries: BufferGeometry[]; comments: string } {
  const { vertices, triangles, comments } = readPlyMesh(bytes, checkCount);
  return { geometries: [new BufferGeometry().setAttribute("position", new BufferAttribute(vertices, 3)).setIndex(triangles)], comments };
}

function fromStl(bytes: Uint8Array): { geometries: BufferGeometry[]; comments: string } {
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
  return { geometries: [new STLLoader().parse(bufferOf(bytes))], comments: textOf(bytes.subarray(0, 80)) };
}

function fromObj(bytes: Uint8Array): { geometries: BufferGeometry[]; comments: string } {
  const text = textOf(bytes);
  const geometries: BufferGeometry[] = [];
  new OBJLoader().parse(text).traverse((each) => {
    if (each instanceof Mesh) geometries.push(each.geometry as BufferGeometry);
  });
  return { geometries, comments: text.slice(0, maxHeaderBytes).split("\n").filter((line) => line.startsWith("#")).join("\n") };
}

// Vertices of equal coordinates as one.
export function welded(geometries: BufferGeometry[]): TriangleMesh {
  const count = geometries.reduce((sum, each) => sum + (each.index?.count ?? each.attributes.position!.count), 0);
  if (count === 0 || count % 3 !== 0) throw new Error("it has no triangles");
  checkCount(count / 3);
  const triangles = new Uint32Array(count);
  const vertices: number[] = [];
  const numbers = new Map<string, number>();
  let at = 0;
  for (const { index, attributes } of geometries) {
    const position = attributes.position!;
    for (let i = 0; i < (index?.count ?? position.count); ++i) {
      const from = index ? index.getX(i) : i;
      if (from >= position.count) throw new Error("a face has a corner that is not a vertex");
      const [x, y, z] = [position.getX(from) + 0, position.getY(from) + 0, position.getZ(from) + 0];  // -0 is 0
      if (!Number.isFinite(x + y + z)) throw new Error("a vertex is not finite");
      const key = `${x},${y},${z}`;
      let number = numbers.get(key);
      if (number === undefined) {
        number = vertices.length / 3;
        vertices.push(x, y, z);
        numbers.set(key, number);
      }
      triangles[at++] = number;
    }
  }
  return { vertices: new Float32Array(vertices), triangles };
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
    const read = /\.ply$/i.test(name) ? fromPly : /\.stl$/i.test(name) ? fromStl : fromObj;
    const { geometries, comments } = read(bytes);
    const mesh = welded(geometries);
    geometries.forEach((each) => each.dispose());
    checkPrecision(mesh);
    turnOutwards(mesh);
    return { mesh, stated: statedUnit(comments), isSided: opposedShare(mesh) <= maxOpposedShare };
  } catch (error) {
    const text = error instanceof Error && error.constructor === Error ? error.message : `it cannot be read (${String(error)}); export it again as PLY, OBJ or STL`;
    throw new Error(`${name} is no usable mesh: ${text}`);
  }
}
