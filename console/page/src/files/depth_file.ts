// A depth image: PNG of one channel with 16 bits. Browsers decode to 8 bits, so that it is read here.
import { create } from "@bufbuild/protobuf";
import { DepthImageSchema, type CameraIntrinsics, type DepthImage } from "../../gen/graspdb/v1/geometry_pb";

const maxPixels = 16_000_000;

export interface Camera { fx: number; fy: number; cx: number; cy: number; depthUnitM: number }

async function inflate(parts: Uint8Array[], size: number): Promise<Uint8Array> {
  const reader = new Blob(parts as BlobPart[]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const out = new Uint8Array(size);
  let at = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (at + value.length > size) throw new Error("the image has more bytes than its size needs");
    out.set(value, at);
    at += value.length;
  }
  if (at !== size) throw new Error("the image ends before its last row");
  return out;
}

const paeth = (a: number, b: number, c: number): number => {
  const p = a + b - c;
  const [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
};

// Undoes the filter of each row; two bytes a pixel, behind the row's filter.
function unfilter(bytes: Uint8Array, width: number, height: number): Uint8Array {
  const row = 2 * width;
  const out = new Uint8Array(row * height);
  for (let y = 0; y < height; ++y) {
    const filter = bytes[y * (row + 1)]!;
    if (filter > 4) throw new Error("a row has an unknown filter");
    for (let i = 0; i < row; ++i) {
      const left = i >= 2 ? out[y * row + i - 2]! : 0;
      const up = y > 0 ? out[(y - 1) * row + i]! : 0;
      const corner = i >= 2 && y > 0 ? out[(y - 1) * row + i - 2]! : 0;
      const add = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter]!;
      out[y * row + i] = bytes[y * (row + 1) + 1 + i]! + add;
    }
  }
  return out;
}

export async function readDepthPng(bytes: Uint8Array): Promise<{ width: number; height: number; data: Uint8Array }> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 45 || view.getUint32(0) !== 0x89504e47) throw new Error("it is not a PNG");
  const width = view.getUint32(16);
  const height = view.getUint32(20);
  if (bytes[24] !== 16 || bytes[25] !== 0) throw new Error("it is not a depth image: one channel of 16 bits");
  if (bytes[28] !== 0) throw new Error("it is interlaced");
  if (width === 0 || height === 0 || width * height > maxPixels) throw new Error("its size is not one of a depth camera");
  const parts: Uint8Array[] = [];
  for (let at = 8; at + 12 <= bytes.length;) {
    const size = view.getUint32(at);
    if (at + 12 + size > bytes.length) throw new Error("the file is cut off");
    if (view.getUint32(at + 4) === 0x49444154) parts.push(bytes.subarray(at + 8, at + 8 + size));
    at += 12 + size;
  }
  const big = unfilter(await inflate(parts, (2 * width + 1) * height), width, height);
  const data = new Uint8Array(big.length);
  for (let i = 0; i < big.length; i += 2) {
    data[i] = big[i + 1]!;
    data[i + 1] = big[i]!;
  }
  return { width, height, data };
}

// The values of intrinsics.json as graspdb writes it.
export function readIntrinsics(text: string): Camera {
  const json = JSON.parse(text) as Record<string, unknown>;
  const number = (...names: string[]): number | undefined => {
    const value = names.map((name) => json[name]).find((each) => each !== undefined);
    return value === undefined ? undefined : Number(value);
  };
  const out = { fx: number("fx"), fy: number("fy"), cx: number("cx"), cy: number("cy"), depthUnitM: number("depthUnitM", "depth_unit_m") ?? 0.001 };
  for (const [name, value] of Object.entries(out)) {
    if (value === undefined || !Number.isFinite(value)) throw new Error(`it has no number ${name}`);
  }
  return out as Camera;
}

export function depthImage(image: { width: number; height: number; data: Uint8Array }, camera: Camera): DepthImage {
  const intrinsics: Partial<CameraIntrinsics> = {
    width: image.width, height: image.height, fx: camera.fx, fy: camera.fy, cx: camera.cx, cy: camera.cy,
  };
  return create(DepthImageSchema, { intrinsics: intrinsics as CameraIntrinsics, depthUnitM: camera.depthUnitM, data: image.data });
}
