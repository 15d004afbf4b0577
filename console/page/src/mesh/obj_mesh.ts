// Meshes in OBJ files: their vertices and faces alone. A file may have any bytes.
import { trianglesOf, type PolygonMesh } from "./polygons";

// Of a corner such as 3, 3/1, 3//2 or -1; the last one is the newest vertex.
function positionOf(corner: string, vertexCount: number): number {
  const number = Number(corner.split("/")[0]);
  return number < 0 ? vertexCount + number : number - 1;
}

// Throws where it cannot be read. `checkCount`: throws where there are too many triangles.
export function readObjMesh(bytes: Uint8Array, checkCount: (triangles: number) => void): PolygonMesh {
  const coordinates: number[] = [];
  const polygons: number[][] = [];
  const comments: string[] = [];
  const lines = new TextDecoder("latin1").decode(bytes).split("\n");
  for (let at = 0; at < lines.length; ++at) {
    const words = lines[at]!.trim().split(/\s+/);
    const keyword = words.shift()!;
    if (keyword.startsWith("#")) comments.push(lines[at]!);
    if (keyword !== "v" && keyword !== "f") continue;
    // A line that ends in a backslash goes on in the next one.
    while (words.at(-1)?.endsWith("\\") && at + 1 < lines.length) {
      const last = words.pop()!.slice(0, -1);
      words.push(...[last, ...lines[++at]!.trim().split(/\s+/)].filter((each) => each !== ""));
    }
    if (keyword === "v") coordinates.push(...[0, 1, 2].map((i) => Number(words[i])));
    else polygons.push(words.map((word) => positionOf(word, coordinates.length / 3)));
  }
  const vertices = new Float32Array(coordinates);
  return { vertices, triangles: trianglesOf(vertices, polygons, checkCount), comments: comments.join("\n") };
}
