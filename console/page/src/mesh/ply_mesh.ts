// Meshes in PLY files, whose faces may have any number of corners. A file may have any bytes.
import { headerOf, plyTypes, readers } from "../files/point_file";
import { trianglesOf, type PolygonMesh } from "./polygons";

interface Property { name: string; type: string; lengthType: string }  // `lengthType`: of a list; else empty
interface Element { name: string; count: number; properties: Property[] }

// One value after the other.
interface Values { next: (type: string) => number; isAtEnd: () => boolean }

function typeOf(name = ""): string {
  const type = plyTypes[name];
  if (!type) throw new Error(`it has the unknown type ${name}`);
  return type;
}

function elementsOf(lines: string[], byteCount: number): Element[] {
  const out: Element[] = [];
  for (const line of lines) {
    const [word, ...cells] = line.split(/\s+/);
    if (word === "element") {
      const count = Number(cells[1]);
      if (!Number.isInteger(count) || count < 0 || count > byteCount) throw new Error(`its element ${cells[0]} has no possible count`);
      out.push({ name: cells[0] ?? "", count, properties: [] });
    } else if (word === "property") {
      const isList = cells[0] === "list";
      const [type, name = ""] = isList ? cells.slice(2) : cells;
      out.at(-1)?.properties.push({ name, type: typeOf(type), lengthType: isList ? typeOf(cells[1]) : "" });
    }
  }
  if (out.some((each) => each.count > 0 && each.properties.length === 0)) throw new Error("an element of it has no properties");
  if (out.some((each) => each.name === "tristrips")) throw new Error("it has triangle strips; export it with triangles");
  return out;
}

const isCorners = ({ name, lengthType }: Property): boolean => lengthType !== "" && /^vertex_ind(ices|ex)$/.test(name);
const tooShort = "it ends before its last row";

function valuesOfText(bytes: Uint8Array): Values {
  const text = new TextDecoder("latin1").decode(bytes);
  const word = /\S+/g;
  return {
    next: () => {
      const found = word.exec(text);
      if (!found) throw new Error(tooShort);
      return Number(found[0]);
    },
    isAtEnd: () => !word.test(text),
  };
}

function valuesOfBytes(bytes: Uint8Array, little: boolean): Values {
  const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  return {
    next: (type) => {
      const [size, read] = readers[type]!;
      if (at + size > data.byteLength) throw new Error(tooShort);
      at += size;
      return read(data, at - size, little);
    },
    isAtEnd: () => at === data.byteLength,
  };
}

function readList(values: Values, { type, lengthType }: Property): number[] {
  const length = values.next(lengthType);
  if (!Number.isInteger(length) || length < 0) throw new Error("a list of it has a negative length");
  const out: number[] = [];
  while (out.length < length) out.push(values.next(type));
  return out;
}

function readVertices(values: Values, { count, properties }: Element): Float32Array {
  const places = properties.map((each) => each.lengthType === "" ? ["x", "y", "z"].indexOf(each.name) : -1);
  for (const [place, name] of ["x", "y", "z"].entries()) if (!places.includes(place)) throw new Error(`its vertices have no ${name}`);
  const out = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    properties.forEach((each, k) => {
      if (each.lengthType !== "") return void readList(values, each);
      const value = values.next(each.type);
      if (places[k]! >= 0) out[3 * i + places[k]!] = value;
    });
  }
  return out;
}

// Of the faces; of other rows, which are skipped so, none.
function readCorners(values: Values, { count, properties }: Element): number[][] {
  const out: number[][] = [];
  for (let i = 0; i < count; ++i) {
    for (const each of properties) {
      if (each.lengthType === "") values.next(each.type);
      else {
        const list = readList(values, each);
        if (isCorners(each)) out.push(list);
      }
    }
  }
  return out;
}

// Throws where it cannot be read. `checkCount`: throws where there are too many triangles.
export function readPlyMesh(bytes: Uint8Array, checkCount: (triangles: number) => void): PolygonMesh {
  const { lines, end } = headerOf(bytes, (line) => line === "end_header");
  if (lines[0] !== "ply") throw new Error("it does not begin as a PLY file");
  const format = lines.find((line) => line.startsWith("format "))?.split(/\s+/)[1];
  const elements = elementsOf(lines, bytes.length);
  if (!elements.some((each) => each.name === "face" && each.properties.some(isCorners))) throw new Error("its faces are no lists of corners");
  const body = bytes.subarray(end);
  const values = format === "ascii" ? valuesOfText(body) : valuesOfBytes(body, format === "binary_little_endian");
  let vertices: Float32Array = new Float32Array();
  let polygons: number[][] = [];
  for (const element of elements) {
    if (element.name === "vertex") vertices = readVertices(values, element);
    else {
      const read = readCorners(values, element);
      if (element.name === "face") polygons = read;
    }
  }
  if (!values.isAtEnd()) throw new Error("it has more than its header says");
  if (polygons.length === 0) throw new Error("it has no faces");
  return { vertices, triangles: trianglesOf(vertices, polygons, checkCount), comments: lines.filter((line) => /^(comment|obj_info)\s/.test(line)).join("\n") };
}
