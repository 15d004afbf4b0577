// point_files_test.mjs WORK: the page's readers of point files, depth images and bundles. WORK: where the page was built.
import { strict as assert } from "node:assert";
import { resolve } from "node:path";
import { test } from "node:test";
import { png } from "./depth_png.mjs";
import { bundleBytes, pageModule, temporaryFolder } from "./programs.mjs";

const work = resolve(process.argv[2]);
const out = temporaryFolder();
const { readPcd, readPly, decompress } = await pageModule(work, "files/point_file", out);
const { readDepthPng, readIntrinsics, depthImage } = await pageModule(work, "files/depth_file", out);
const { readBundle } = await pageModule(work, "files/bundle_file", out);
const { pointsOfCloud, pointsOfDepth } = await pageModule(work, "base/geometry", out);

const points = [[0.1, -0.2, 0.9], [0.5, 0.25, 1.5], [NaN, NaN, NaN]];
const text = new TextEncoder();
const bytes = (...parts) => new Uint8Array(Buffer.concat(parts.map((part) => typeof part === "string" ? text.encode(part) : part)));
const header = (data, extra = "") => `# .PCD v0.7
VERSION 0.7
FIELDS rgb x y z
SIZE 4 4 8 4
TYPE U F F F
COUNT 1 1 1 1
WIDTH 3
HEIGHT 1
${extra}POINTS 3
DATA ${data}
`;
function packed() {
  const buffer = Buffer.alloc(3 * 20);
  points.forEach(([x, y, z], i) => {
    buffer.writeUInt32LE(7, 20 * i);
    buffer.writeFloatLE(x, 20 * i + 4);
    buffer.writeDoubleLE(y, 20 * i + 8);
    buffer.writeFloatLE(z, 20 * i + 16);
  });
  return buffer;
}
const near = (actual, expected) => {
  assert.equal(actual.length, expected.length);
  expected.forEach((value, i) => assert.ok(Math.abs(actual[i] - value) < 1e-5, `${actual[i]} is not ${value}`));
};
const measured = points.slice(0, 2).flat();

test("a PCD of text", () => {
  const file = readPcd(bytes(header("ascii"), points.map(([x, y, z]) => `1 ${x} ${y} ${z}\n`).join("")));
  near(pointsOfCloud(file.cloud), measured);
  assert.equal(file.sensorPose, undefined);
});

test("a PCD of bytes", () => {
  near(pointsOfCloud(readPcd(bytes(header("binary"), packed())).cloud), measured);
});

test("a compressed PCD", () => {
  // Column by column, in literals of up to 32 bytes.
  const rows = packed();
  const columns = Buffer.concat([[0, 4], [4, 4], [8, 8], [16, 4]].flatMap(([at, size]) =>
    points.map((_, i) => rows.subarray(20 * i + at, 20 * i + at + size))));
  const lzf = [];
  for (let at = 0; at < columns.length; at += 32) {
    const literal = columns.subarray(at, at + 32);
    lzf.push(Buffer.from([literal.length - 1]), literal);
  }
  const data = Buffer.concat(lzf);
  const sizes = Buffer.alloc(8);
  sizes.writeUInt32LE(data.length, 0);
  sizes.writeUInt32LE(columns.length, 4);
  near(pointsOfCloud(readPcd(bytes(header("binary_compressed"), sizes, data)).cloud), measured);
});

test("copies within compressed bytes", () => {
  // "ab", then 7 bytes from 2 before; then 10 bytes from 1 before, whose length takes a byte of its own.
  const plain = decompress(new Uint8Array([1, 97, 98, (5 << 5) | 0, 1, (7 << 5) | 0, 1, 0]), 19);
  assert.equal(new TextDecoder().decode(plain), "ababababa" + "a".repeat(10));
  assert.throws(() => decompress(new Uint8Array([(5 << 5) | 0, 1]), 7), /damaged/);
  assert.throws(() => decompress(new Uint8Array([3, 1]), 4), /damaged/);
  assert.throws(() => decompress(new Uint8Array([0, 1]), 2), /damaged/);
});

test("the VIEWPOINT of a PCD is the sensor pose", () => {
  const lines = points.map(([x, y, z]) => `1 ${x} ${y} ${z}\n`).join("");
  const { sensorPose } = readPcd(bytes(header("ascii", "VIEWPOINT 0.1 0.2 0.3 0.5 0.5 -0.5 0.5\n"), lines));
  assert.deepEqual([sensorPose.position.x, sensorPose.orientation.w, sensorPose.orientation.y], [0.1, 0.5, -0.5]);
  assert.equal(readPcd(bytes(header("ascii", "VIEWPOINT 0 0 0 1 0 0 0\n"), lines)).sensorPose, undefined);
});

test("a PLY of text and of bytes", () => {
  const ply = (format) => `ply\nformat ${format} 1.0\nelement vertex 3\nproperty uchar red\nproperty float x\nproperty double y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n`;
  near(pointsOfCloud(readPly(bytes(ply("ascii"), points.map((point) => `1 ${point.join(" ")}\n`).join(""), "3 0 1 2\n")).cloud), measured);
  for (const big of [false, true]) {
    const buffer = Buffer.alloc(3 * 17);
    const view = new DataView(buffer.buffer, buffer.byteOffset);
    points.forEach(([x, y, z], i) => {
      view.setFloat32(17 * i + 1, x, !big);
      view.setFloat64(17 * i + 5, y, !big);
      view.setFloat32(17 * i + 13, z, !big);
    });
    near(pointsOfCloud(readPly(bytes(ply(big ? "binary_big_endian" : "binary_little_endian"), buffer)).cloud), measured);
  }
});

test("damaged files are refused", () => {
  for (const [file, reason] of [
    ["", /no end/], ["x".repeat(1_000_000), /no end/], [header("ascii"), /ends after 0 of 3/], [header("binary"), /ends before/],
    [header("other"), /DATA/], [header("binary").replace("POINTS 3", "POINTS 99999999"), /more than/],
    [header("binary").replace("POINTS 3", "POINTS -1"), /number of points/], [header("ascii").replace(" z", " q"), /no z/],
    [header("binary").replace("SIZE 4", "SIZE 999"), /SIZE/],
    [bytes(header("binary_compressed"), new Uint8Array([255, 255, 255, 255, 60, 0, 0, 0])), /damaged/],
  ]) assert.throws(() => readPcd(bytes(file)), reason);
  assert.throws(() => readPly(bytes("ply\nformat ascii 1.0\nelement vertex 1e9\nend_header\n")), /more than|number of points/);
  assert.throws(() => readPly(bytes("ply\nformat ascii 1.0\nelement face 1\nend_header\n")), /vertex/);
});

test("no bytes bring the readers to another end than an error", () => {
  let state = 1;
  const random = (most) => (state = (state * 48271) % 2147483647) % most;
  const files = [bytes(header("ascii"), "1 1 1 1\n1 1 1 1\n1 1 1 1\n"), bytes(header("binary"), packed())];
  for (let i = 0; i < 20_000; ++i) {
    const file = files[i % files.length].slice();
    for (let change = 0; change <= random(4); ++change) file[random(file.length)] = random(256);
    for (const read of [readPcd, readPly]) {
      try {
        read(file);
      } catch (error) {
        assert.equal(error.constructor.name === "Error" || error instanceof RangeError, true, String(error));
      }
    }
  }
});

test("a bundle of a black box", async () => {
  const file = await bundleBytes(work, out, {
    robot: "r", request: { cell: "cells/a", depthImage: { intrinsics: { width: 2, height: 1 }, data: "AQIDBA==" } }, error: { code: 5, message: "gone" },
  });
  const bundle = readBundle(new Uint8Array(file));
  assert.deepEqual([bundle.robot, bundle.request.cell, bundle.result.value.message], ["r", "cells/a", "gone"]);
  assert.deepEqual([...bundle.request.scan.value.data], [1, 2, 3, 4]);
  const changed = (at, byte) => {
    const copy = new Uint8Array(file);
    copy[at] = byte;
    return copy;
  };
  assert.throws(() => readBundle(changed(0, 65)), /not a bundle/);
  assert.throws(() => readBundle(changed(3, 2)), /newer version/);
  assert.throws(() => readBundle(new Uint8Array()), /not a bundle/);
  for (let size = 4; size < file.length; ++size) {
    // Cut where a field ends, it has no result.
    assert.throws(() => readBundle(new Uint8Array(file.subarray(0, size))), /truncated or damaged/, String(size));
  }
  let state = 3;
  const random = (most) => (state = (state * 48271) % 2147483647) % most;
  for (let i = 0; i < 20_000; ++i) {
    const copy = changed(4 + random(file.length - 4), random(256));
    copy[4 + random(file.length - 4)] = random(256);
    try {
      readBundle(copy);
    } catch (error) {
      assert.match(error.message, /truncated or damaged/);
    }
  }
});

test("a depth image with every filter", async () => {
  const rows = Array.from({ length: 7 }, (_, y) => Array.from({ length: 6 }, (__, x) => (y * 7919 + x * 311) % 65536));
  const image = await readDepthPng(png(rows));
  assert.deepEqual([image.width, image.height], [6, 7]);
  rows.flat().forEach((value, i) => assert.equal(image.data[2 * i] + 256 * image.data[2 * i + 1], value));
});

test("the points of a depth image", async () => {
  const image = await readDepthPng(png([[0, 1000, 65535], [0, 0, 2000]]));
  const camera = readIntrinsics('{"fx": 100, "fy": 200, "cx": 1, "cy": 0, "depthUnitM": 0.001}');
  near(pointsOfDepth(depthImage(image, camera)), [0, 0, 1, 0.02, 0.01, 2]);
  assert.throws(() => readIntrinsics('{"fx": 1}'), /no number/);
});

test("damaged depth images are refused", async () => {
  const good = png([[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]]);
  await assert.rejects(readDepthPng(good.subarray(0, 60)), /cut off|last row|error/i);
  await assert.rejects(readDepthPng(bytes("x".repeat(100))), /not a PNG/);
  const eight = good.slice();
  eight[24] = 8;
  await assert.rejects(readDepthPng(eight), /16 bits/);
  const large = good.slice();
  large[16] = 127;
  await assert.rejects(readDepthPng(large), /size/);
  const wide = good.slice();
  wide[19] = 99;
  await assert.rejects(readDepthPng(wide));
});
