// A small picture of a view: the part of its depth image that shows the object.
import type { DepthImage } from "../../gen/graspdb/v1/geometry_pb";
import { h } from "../base/dom";
import type { Seen } from "./mesh_views";

const size = 72;

// Near is bright, not measured is black.
export function viewThumbnail(image: DepthImage, seen: Seen): HTMLCanvasElement {
  const canvas = h("canvas", { width: size, height: size, role: "presentation" });
  const context = canvas.getContext("2d");
  const { width = 0, height = 0 } = image.intrinsics ?? {};
  if (!context) return canvas;
  const data = new DataView(image.data.buffer, image.data.byteOffset, image.data.byteLength);
  const pixels = context.createImageData(size, size);
  for (let i = 0; i < size * size; ++i) {
    const u = seen.left + Math.floor(((i % size) * seen.side) / size);
    const v = seen.top + Math.floor((Math.floor(i / size) * seen.side) / size);
    const isInside = u >= 0 && v >= 0 && u < width && v < height;
    const depth = isInside ? data.getUint16(2 * (v * width + u), true) * image.depthUnitM : 0;
    const nearness = Math.min(1, Math.max(0, (seen.far - depth) / Math.max(1e-6, seen.far - seen.near)));
    const shade = depth > 0 ? 45 + 210 * nearness : 0;
    pixels.data.set([shade, shade, shade, 255], 4 * i);
  }
  context.putImageData(pixels, 0, 0);
  return canvas;
}
