// Files of points, as a cloud of the contract: PCD (ascii, binary, binary_compressed) and PLY (ascii, binary).
import { create } from "@bufbuild/protobuf";
import { PackedElementField_NumericType as NumericType, PointCloudSchema, PoseSchema, type PointCloud, type Pose } from "../../gen/graspdb/v1/geometry_pb";

export const maxFileBytes = 256 * 1024 * 1024;
export const maxPoints = 4_000_000;
const maxHeaderBytes = 64 * 1024;

export interface PointFile { cloud: PointCloud; sensorPose?: Pose }

interface Column { name: string; type: string; offset: number; size: number; count: number }

// The lines of a text header up to the one that `isLast`, and where the data begin.
export function headerOf(bytes: Uint8Array, isLast: (line: string) => boolean): { lines: string[]; end: number } {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, maxHeaderBytes));
  const lines: string[] = [];
  for (let at = 0; ;) {
    const end = text.indexOf("\n", at);
    if (end < 0) throw new Error("the header has no end");
    const line = text.slice(at, end).trim();
    lines.push(line);
    at = end + 1;
    if (isLast(line)) return { lines, end: at };
  }
}

function checkedCount(text: string | undefined): number {
  const value = Number(text);
  if (!Number.isInteger(value) || value < 0) throw new Error("the header has no number of points");
  if (value > maxPoints) throw new Error(`more than ${maxPoints.toLocaleString("en")} points`);
  return value;
}

function cloudOf(points: Float32Array, width: number): PointCloud {
  return create(PointCloudSchema, {
    pointStride: 12, width,
    fields: ["x", "y", "z"].map((name, i) => ({ name, offset: 4 * i, type: NumericType.FLOAT32 })),
    data: new Uint8Array(points.buffer, points.byteOffset, points.byteLength),
  });
}

export const readers: Record<string, [number, (data: DataView, at: number, little: boolean) => number]> = {
  I1: [1, (d, at) => d.getInt8(at)], U1: [1, (d, at) => d.getUint8(at)],
  I2: [2, (d, at, l) => d.getInt16(at, l)], U2: [2, (d, at, l) => d.getUint16(at, l)],
  I4: [4, (d, at, l) => d.getInt32(at, l)], U4: [4, (d, at, l) => d.getUint32(at, l)],
  F4: [4, (d, at, l) => d.getFloat32(at, l)], F8: [8, (d, at, l) => d.getFloat64(at, l)],
};

function axes(columns: Column[]): Column[] {
  return ["x", "y", "z"].map((name) => {
    const column = columns.find((each) => each.name === name);
    if (!column) throw new Error(`the points have no ${name}`);
    return column;
  });
}

function fromText(text: string, columns: Column[], count: number): Float32Array {
  const places = axes(columns).map((axis) =>
    columns.slice(0, columns.indexOf(axis)).reduce((sum, column) => sum + column.count, 0));
  const out = new Float32Array(3 * count);
  let size = 0;
  let at = 0;
  while (size < out.length) {
    if (at >= text.length) throw new Error(`it ends after ${size / 3} of ${count} points`);
    const end = text.indexOf("\n", at);
    const cells = text.slice(at, end < 0 ? text.length : end).trim().split(/\s+/);
    at = end < 0 ? text.length : end + 1;
    if (cells.length === 1 && cells[0] === "") continue;
    for (const place of places) out[size++] = Number(cells[place]);
  }
  return out;
}

// `placeOf`: where the value of a column is for a point.
function fromBytes(
  data: DataView, columns: Column[], count: number, little: boolean, placeOf: (column: Column, point: number) => number,
): Float32Array {
  const wanted = axes(columns).map((column) => {
    const reader = readers[column.type];
    if (!reader) throw new Error(`${column.name} has the unknown type ${column.type}`);
    return { column, read: reader[1] };
  });
  const out = new Float32Array(3 * count);
  let size = 0;
  for (let point = 0; point < count; ++point) {
    for (const { column, read } of wanted) out[size++] = read(data, placeOf(column, point), little);
  }
  return out;
}

// LZF, as liblzf writes it.
export function decompress(bytes: Uint8Array, size: number): Uint8Array {
  const out = new Uint8Array(size);
  let to = 0;
  for (let from = 0; from < bytes.length;) {
    const control = bytes[from++]!;
    if (control < 32) {
      const length = control + 1;
      if (from + length > bytes.length || to + length > size) throw new Error("the compressed points are damaged");
      out.set(bytes.subarray(from, from + length), to);
      from += length;
      to += length;
      continue;
    }
    let length = control >> 5;
    if (length === 7) length += bytes[from++] ?? 0;
    const distance = ((control & 31) << 8) + (bytes[from++] ?? 0) + 1;
    length += 2;
    if (distance > to || to + length > size) throw new Error("the compressed points are damaged");
    for (let i = 0; i < length; ++i, ++to) out[to] = out[to - distance]!;
  }
  if (to !== size) throw new Error("the compressed points are damaged");
  return out;
}

// T_world_sensor of the line VIEWPOINT; that of the identity is unknown.
function viewpoint(cells: string[] | undefined): Pose | undefined {
  const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = (cells ?? []).map(Number);
  if (x === 0 && y === 0 && z === 0 && qx === 0 && qy === 0 && qz === 0) return undefined;
  return create(PoseSchema, { position: { x, y, z }, orientation: { x: qx, y: qy, z: qz, w: qw } });
}

export function readPcd(bytes: Uint8Array): PointFile {
  const { lines, end } = headerOf(bytes, (line) => line.startsWith("DATA"));
  const header = new Map(lines.filter((line) => line !== "" && !line.startsWith("#")).map((line) => {
    const [key, ...cells] = line.split(/\s+/);
    return [key!, cells] as const;
  }));
  const names = header.get("FIELDS") ?? [];
  const sizes = header.get("SIZE") ?? [];
  const types = header.get("TYPE") ?? [];
  const counts = header.get("COUNT") ?? names.map(() => "1");
  let stride = 0;
  const columns = names.map((name, i): Column => {
    const size = Number(sizes[i]);
    const repeats = Number(counts[i]);
    if (!(size > 0 && size <= 8 && repeats >= 0 && repeats <= 4096)) throw new Error("the header's SIZE or COUNT is wrong");
    const column = { name, type: `${types[i]}${size}`, offset: stride, size, count: repeats };
    stride += size * repeats;
    return column;
  });
  const width = checkedCount(header.get("WIDTH")?.[0]);
  const height = checkedCount(header.get("HEIGHT")?.[0] ?? "1");
  const count = checkedCount(header.get("POINTS")?.[0] ?? String(width * height));
  const data = bytes.subarray(end);
  const kind = header.get("DATA")?.[0];
  let points: Float32Array;
  if (kind === "ascii") {
    points = fromText(new TextDecoder("latin1").decode(data), columns, count);
  } else if (kind === "binary") {
    if (data.length < stride * count) throw new Error("the file ends before its last point");
    points = fromBytes(new DataView(data.buffer, data.byteOffset), columns, count, true,
      (column, point) => point * stride + column.offset);
  } else if (kind === "binary_compressed") {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const packed = view.getUint32(0, true);
    const maxRatio = 100;  // of LZF it is 88
    if (view.getUint32(4, true) !== stride * count || packed > data.length - 8 || stride * count > maxRatio * packed) throw new Error("the compressed points are damaged");
    const plain = decompress(data.subarray(8, 8 + packed), stride * count);
    points = fromBytes(new DataView(plain.buffer), columns, count, true,
      (column, point) => column.offset * count + point * column.size);
  } else {
    throw new Error("its DATA is not ascii, binary or binary_compressed");
  }
  return { cloud: cloudOf(points, height > 1 && width * height === count ? width : 0), sensorPose: viewpoint(header.get("VIEWPOINT")) };
}

export const plyTypes: Record<string, string> = {
  char: "I1", int8: "I1", uchar: "U1", uint8: "U1", short: "I2", int16: "I2", ushort: "U2", uint16: "U2",
  int: "I4", int32: "I4", uint: "U4", uint32: "U4", float: "F4", float32: "F4", double: "F8", float64: "F8",
};

export function readPly(bytes: Uint8Array): PointFile {
  const { lines, end } = headerOf(bytes, (line) => line === "end_header");
  const format = lines.find((line) => line.startsWith("format "))?.split(/\s+/)[1];
  let element = "";
  let count = -1;
  let stride = 0;
  const columns: Column[] = [];
  for (const line of lines) {
    const [word, first, second] = line.split(/\s+/);
    if (word === "element") {
      if (count < 0 && first !== "vertex") throw new Error("its first element is not vertex");
      element = first ?? "";
      if (element === "vertex") count = checkedCount(second);
    } else if (word === "property" && element === "vertex") {
      const type = plyTypes[first ?? ""];
      if (!type) throw new Error(`a point has the type ${first}`);
      const size = readers[type]![0];
      columns.push({ name: second ?? "", type, offset: stride, size, count: 1 });
      stride += size;
    }
  }
  if (count < 0) throw new Error("it has no points");
  const data = bytes.subarray(end);
  if (format === "ascii") return { cloud: cloudOf(fromText(new TextDecoder("latin1").decode(data), columns, count), 0) };
  if (format !== "binary_little_endian" && format !== "binary_big_endian") throw new Error(`its format is ${format}`);
  if (data.length < stride * count) throw new Error("the file ends before its last point");
  return {
    cloud: cloudOf(fromBytes(new DataView(data.buffer, data.byteOffset), columns, count, format === "binary_little_endian",
      (column, point) => point * stride + column.offset), 0),
  };
}
