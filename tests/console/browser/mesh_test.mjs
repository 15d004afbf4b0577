// mesh_test.mjs BIN WORK: the page's stable poses, symmetries and grasps of meshes are those of `graspdb teach --dry-run`, and files that
// are no usable meshes are refused. WORK: where the page was built.
import { strict as assert } from "node:assert";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pageModule, temporaryFolder } from "./programs.mjs";

const [bin, work] = process.argv.slice(2).map((path) => resolve(path));
const folder = temporaryFolder();
const modules = {};
for (const name of ["mesh_file", "stable_poses", "top_grasps", "triangle_mesh", "depth_camera"]) modules[name] = await pageModule(work, `mesh/${name}`, folder);
const { readMesh, lengthUnits, fittingUnits, largestSideOf } = modules.mesh_file;
const { findStablePoses } = modules.stable_poses;
const { proposeTopGrasps } = modules.top_grasps;
const { areaOf, scaled, transformed, solidOf } = modules.triangle_mesh;
const graspdb = (...args) => execFileSync(join(bin, "graspdb"), args, { stdio: ["ignore", "pipe", "pipe"] }).toString();

// The rows of the table of stable poses, and the declaration in JSON.
function ofCommand(file, unit) {
  const args = ["teach", "part", "--mesh", file, "--unit", unit, "--dry-run"];
  const rows = graspdb(...args).split("\n").filter((line) => line.startsWith("resting-")).map((line) => {
    const [, id, probability, tips] = /^(\S+)\s+([\d.]+)\s+([-\d.]+)\s/.exec(line);
    return { id, probability: Number(probability), tips: Number(tips), rolls: line.includes(", rolls") };
  });
  const declared = JSON.parse(graspdb(...args, "--json")).stablePoses;
  return rows.map((row, i) => ({ ...row, symmetryOrder: declared[i].symmetryOrder ?? 1, grasps: declared[i].grasps ?? [], meshPose: declared[i].meshPose }));
}

function ofPage(file, unit) {
  const read = readMesh(file, new Uint8Array(readFileSync(file)));
  const mesh = scaled(read.mesh, lengthUnits[unit]);
  const found = findStablePoses(mesh, () => {});
  return found.poses.map((pose) => ({
    ...pose, grasps: proposeTopGrasps(transformed(mesh, pose.objectMesh), found.mass.center.clone().applyMatrix4(pose.objectMesh), pose.symmetryOrder === 0),
  }));
}

// The mesh's direction that is up.
function upOf({ orientation: { x = 0, y = 0, z = 0, w = 0 } }) {
  return [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}
const near = (a, b, most, what) => assert.ok(Math.abs(a - b) <= most, `${what}: ${a} instead of ${b}`);

// `isSymmetric`: several orientations are one stable pose, of which either program takes one.
function compare(name, file, unit, isSymmetric = false) {
  const [mine, theirs] = [ofPage(file, unit), ofCommand(file, unit)];
  console.log(`== ${name}: ${theirs.map((each) => `${each.id} ${each.probability} % ${each.symmetryOrder}`).join(", ")}`);
  assert.deepEqual(mine.map((each) => each.id), theirs.map((each) => each.id));
  for (const pose of theirs) {
    const up = upOf(pose.meshPose);
    // Equally probable ones may have changed places.
    const alike = mine.find((each) => [2, 6, 10].reduce((sum, at, k) => sum + each.objectMesh.elements[at] * up[k], 0) > 0.9999);
    const found = alike ?? (isSymmetric ? mine.find((each) => each.id === pose.id) : undefined);
    const what = `${name}, ${pose.id}`;
    assert.ok(found, what);
    near(100 * found.probability, pose.probability, 0.11, `${what}, probability`);
    near((found.tipAngle * 180) / Math.PI, pose.tips, 0.11, `${what}, tip angle`);
    assert.equal(found.rolls, pose.rolls, what);
    assert.equal(found.symmetryOrder, pose.symmetryOrder, what);
    near(found.objectMesh.elements[14], pose.meshPose.position.z ?? 0, 1e-5, `${what}, height`);
    assert.deepEqual(found.grasps.map((each) => each.graspId), pose.grasps.map((each) => each.graspId), what);
    found.grasps.forEach((grasp, i) => near(grasp.gripperOpeningM, pose.grasps[i].gripperOpeningM, 0.0005, `${what}, opening`));
    // Where the mesh is not turned upside down, for which there are several shortest turns, the frames are the same.
    if (isSymmetric || up[2] < -0.999) continue;
    near(found.objectMesh.elements[12], pose.meshPose.position.x ?? 0, 1e-5, `${what}, x`);
    near(found.objectMesh.elements[13], pose.meshPose.position.y ?? 0, 1e-5, `${what}, y`);
    found.grasps.forEach((grasp, i) => ["x", "y", "z"].forEach((axis) =>
      near(grasp.tcpPose.position[axis], pose.grasps[i].tcpPose.position[axis] ?? 0, 0.0005, `${what}, ${grasp.graspId} ${axis}`)));
  }
}

const parts = ["bracket-left", "flange", "hex-nut", "stepped-shaft", "wedge"];
const symmetric = ["flange", "hex-nut", "stepped-shaft"];
graspdb("simulate", "--parts", parts.join(","), "--step", "120", "--out", join(folder, "parts"));
const models = join(folder, "parts/models");
assert.deepEqual(readdirSync(models).sort(), parts.map((each) => `${each}.ply`));
for (const name of parts) compare(name, join(models, `${name}.ply`), "m", symmetric.includes(name));

console.log("== other formats and units");
const wedge = readMesh("wedge.ply", new Uint8Array(readFileSync(join(models, "wedge.ply")))).mesh;
const { volume } = solidOf(wedge);
const corners = (scale) => [...wedge.triangles].map((i) => [...wedge.vertices.subarray(3 * i, 3 * i + 3)].map((each) => each * scale));
const facets = (scale) => Array.from({ length: wedge.triangles.length / 3 }, (_, i) => corners(scale).slice(3 * i, 3 * i + 3));
function binaryStl(all) {
  const out = Buffer.alloc(84 + 50 * all.length);
  out.write("units: mm");
  out.writeUInt32LE(all.length, 80);
  all.forEach((facet, i) => facet.flat().forEach((value, k) => out.writeFloatLE(value, 84 + 50 * i + 12 + 4 * k)));
  return out;
}
const textStl = (all) => Buffer.from(`solid part\n${all.map((facet) => `facet normal 0 0 1\nouter loop\n${facet.map((each) => `vertex ${each.join(" ")}`).join("\n")}\nendloop\nendfacet`).join("\n")}\nendsolid part\n`);
const obj = (all) => Buffer.from(`# File units = millimeters\n${all.flat().map((each) => `v ${each.join(" ")}`).join("\n")}\n${all.map((_, i) => `f ${3 * i + 1} ${3 * i + 2} ${3 * i + 3}`).join("\n")}\n`);
const inMillimetres = facets(1000);
// All facets turned inwards, as of a mirrored part; and one of them alone.
const turned = inMillimetres.map((facet) => [...facet].reverse());
for (const [name, bytes, stated] of [
  ["a.stl", binaryStl(inMillimetres), "mm"], ["b.STL", textStl(inMillimetres), ""], ["c.obj", obj(inMillimetres), "mm"],
  ["d.stl", binaryStl(turned), "mm"], ["e.stl", binaryStl([turned[0], ...inMillimetres.slice(1)]), "mm"],
]) {
  const read = readMesh(name, new Uint8Array(bytes));
  assert.equal(read.stated, stated, name);
  assert.equal(read.mesh.vertices.length, wedge.vertices.length, name);
  near(solidOf(scaled(read.mesh, 0.001)).volume / volume, 1, 1e-4, name);
}
writeFileSync(join(folder, "wedge.stl"), binaryStl(turned));
compare("wedge in millimetres, turned inwards", join(folder, "wedge.stl"), "mm");
const side = largestSideOf(wedge);
assert.deepEqual(fittingUnits(1000 * side), ["mm"]);
assert.deepEqual(fittingUnits(side), ["m"]);
assert.deepEqual(fittingUnits(1e6), []);

console.log("== faces of more than three corners");
const shapes = {
  // The first corners see neither all of the others.
  "l-prism": [[0.1, 0.02], [0.03, 0.02], [0.03, 0.07], [0, 0.07], [0, 0], [0.06, 0], [0.1, 0]],
  arrow: [[0.1, 0], [0, 0.03], [0.04, 0], [0, -0.05]],
};
const depth = 0.045;
// A prism: its ends have the outline's corners, its sides four.
function prismOf(outline) {
  const n = outline.length;
  const points = [0, depth].flatMap((z) => outline.map(([x, y]) => [x, y, z]));
  const ends = [outline.map((_, i) => n - 1 - i), outline.map((_, i) => n + i)];
  const polygons = [...ends, ...outline.map((_, i) => [i, (i + 1) % n, n + ((i + 1) % n), n + i])];
  return { points, polygons };
}
// As PLY, with the elements in `order`.
function prism(outline, format, order = ["vertex", "face"]) {
  const { points, polygons } = prismOf(outline);
  const head = {
    vertex: `element vertex ${points.length}\nproperty uchar red\nproperty double x\nproperty double y\nproperty double z\n`,
    face: `element face ${polygons.length}\nproperty short flags\nproperty list uint uint vertex_indices\nproperty list uchar float weights\n`,
  };
  const isText = format === "ascii";
  const isLittle = format === "binary_little_endian";
  const text = [];
  const parts = [];
  const put = (value, size, kind) => {
    text.push(value);
    const part = Buffer.alloc(size);
    part[`write${kind}${size === 1 ? "" : isLittle ? "LE" : "BE"}`](value);
    parts.push(part);
  };
  const row = {
    vertex: (point) => {
      put(7, 1, "UInt8");
      point.forEach((each) => put(each, 8, "Double"));
    },
    face: (polygon) => {
      put(-3, 2, "Int16");
      put(polygon.length, 4, "UInt32");
      polygon.forEach((each) => put(each, 4, "UInt32"));
      put(1, 1, "UInt8");
      put(0.5, 4, "Float");
    },
  };
  const rows = { vertex: points, face: polygons };
  for (const element of order) {
    for (const each of rows[element]) {
      row[element](each);
      text.push("\n");
    }
  }
  const header = Buffer.from(`ply\nformat ${format} 1.0\ncomment a prism\n${order.map((each) => head[each]).join("")}end_header\n`);
  return Buffer.concat([header, ...(isText ? [Buffer.from(text.join(" "))] : parts)]);
}
const areaOfOutline = (outline) => Math.abs(outline.reduce((sum, [x, y], i) => {
  const [nextX, nextY] = outline[(i + 1) % outline.length];
  return sum + (x * nextY - nextX * y) / 2;
}, 0));
for (const [name, outline] of Object.entries(shapes)) {
  const around = outline.reduce((sum, [x, y], i) => sum + Math.hypot(x - outline[(i + 1) % outline.length][0], y - outline[(i + 1) % outline.length][1]), 0);
  const variants = [["ascii"], ["binary_little_endian"], ["binary_big_endian"], ["binary_little_endian", ["face", "vertex"]]];
  for (const [format, order] of variants) {
    const { mesh } = readMesh(`${name}.ply`, new Uint8Array(prism(outline, format, order)));
    near(areaOf(mesh), 2 * areaOfOutline(outline) + depth * around, 1e-8, `${name}, ${format}, area`);
    near(solidOf(mesh).volume, areaOfOutline(outline) * depth, 1e-9, `${name}, ${format}, volume`);
  }
  const { points, polygons } = prismOf(outline);
  const corner = (i) => [`${i + 1}`, `${i + 1}/1`, `${i - points.length}//7`][i % 3];
  const asObj = Buffer.from(`# a prism\n${points.map((each) => `v ${each.join(" \\\n")}`).join("\n")}\nvt 0 0\n${polygons.map((each) => `f ${each.map(corner).join(" ")}`).join("\r\n")}\n`);
  const { mesh } = readMesh(`${name}.obj`, new Uint8Array(asObj));
  near(areaOf(mesh), 2 * areaOfOutline(outline) + depth * around, 1e-8, `${name}, obj, area`);
  for (const [ending, bytes] of [["ply", prism(outline, "ascii")], ["obj", asObj]]) {
    const file = join(folder, `${name}.${ending}`);
    writeFileSync(file, bytes);
    compare(`${name}.${ending}`, file, "m");
  }
}

console.log("== files that are no usable meshes");
const ply = (header, data = "") => Buffer.from(`ply\nformat ascii 1.0\n${header}\nend_header\n${data}`);
const vertices = (count) => `element vertex ${count}\nproperty float x\nproperty float y\nproperty float z`;
const faces = (count) => `element face ${count}\nproperty list uchar int vertex_indices`;
const square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 0\n";
const whole = new Uint8Array(readFileSync(join(models, "wedge.ply")));
const refused = [
  ["empty.ply", Buffer.alloc(0), /header/], ["points.ply", ply(vertices(1), "0 0 0\n"), /no lists of corners/],
  ["none.ply", ply(`${vertices(5)}\n${faces(0)}`, square), /no faces/], ["huge.ply", ply(`${vertices(4e9)}\n${faces(1)}`), /no possible count/],
  ["bare.ply", ply(`element nothing 50\n${vertices(5)}\n${faces(1)}`, square), /no properties/],
  ["corners.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}0\n`), /no corners/], ["line.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}2 0 1\n`), /no triangles/],
  ["round.ply", ply(`${vertices(5)}\n${faces(1)}`.replace("uchar", "uint"), `${square}10001 ${"0 ".repeat(10_001)}`), /10,001 corners/],
  ["minus.ply", ply(`${vertices(5)}\n${faces(1)}`.replace("uchar", "char"), `${square}-1\n`), /negative/],
  ["half.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}4 0 1 2 2.5\n`), /not a vertex/], ["below.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}4 0 1 2 -1\n`), /not a vertex/],
  ["more.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}3 0 1 2\n7\n`), /more than its header/], ["strips.ply", ply(`${vertices(5)}\nelement tristrips 1\nproperty list int int vertex_indices\n${faces(1)}`), /strips/],
  ["no-z.ply", ply(`element vertex 1\nproperty float x\nproperty float y\n${faces(1)}`, "0 0\n3 0 0 0\n"), /no z/], ["type.ply", ply(`element vertex 1\nproperty half x\n${faces(1)}`), /type half/],
  ["beyond.ply", ply(`${vertices(5)}\n${faces(1)}`, `${square}3 0 1 9\n`), /not a vertex/],
  ["short.ply", whole.subarray(0, whole.length - 20), /ends before its last row/], ["short.stl", binaryStl(inMillimetres).subarray(0, 200), /its length/],
  ["count.stl", Buffer.from([...binaryStl(inMillimetres).subarray(0, 80), 255, 255, 255, 255, ...Buffer.alloc(100)]), /its length/],
  ["cut.stl", textStl(inMillimetres).subarray(0, 900), /cut short/], ["open.stl", Buffer.from(textStl(inMillimetres).toString().replace("endfacet", "")), /no end/],
  ["nan.stl", binaryStl([[[NaN, 0, 0], [1, 0, 0], [0, 1, 0]]]), /not finite/], ["index.obj", Buffer.from("v 0 0 0\nv 1 0 0\nf 1 2 7\n"), /not a vertex/], ["zero.obj", Buffer.from("v 0 0 0\nf 0 1 1\n"), /not a vertex/],
  ["few.obj", Buffer.from("v 0 0\nf 1 1 1\n"), /not finite/],
  ["nothing.obj", Buffer.from("hello\n"), /no triangles/], ["far.stl", binaryStl(inMillimetres.map((facet) => facet.map(([x, y, z]) => [x + 1e7, y, z]))), /far from its origin/],
];
for (const [name, bytes, reason] of refused) assert.throws(() => readMesh(name, new Uint8Array(bytes)), (error) => error.message.startsWith(name) && reason.test(error.message), `${name} ${reason}`);
// Damaged files are refused, or give a mesh whose triangles have vertices.
const intact = prism(shapes["l-prism"], "binary_little_endian");
for (let i = 0; i < 3000; ++i) {
  const damaged = new Uint8Array(intact);
  for (let k = 0; k <= i % 3; ++k) damaged[modules.depth_camera.randomBits(i, 2 * k) % damaged.length] = modules.depth_camera.randomBits(i, 2 * k + 1);
  try {
    const { mesh } = readMesh("damaged.ply", damaged.subarray(0, damaged.length - (i % 7 === 6 ? i % 300 : 0)));
    assert.ok(mesh.vertices.every(Number.isFinite) && mesh.triangles.every((each) => 3 * each < mesh.vertices.length));
  } catch (error) {
    assert.ok(error.message.startsWith("damaged.ply is no usable mesh: "), String(error));
  }
}
const flat = scaled(readMesh("flat.stl", new Uint8Array(binaryStl([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]]))).mesh, 0.1);
assert.throws(() => findStablePoses(flat, () => {}), /no convex hull/);
console.log("== the noise of the camera");
const { intrinsics, withNoise } = modules.depth_camera;
const size = intrinsics.width * intrinsics.height;
const noisy = (angle, seed) => withNoise(new Float32Array(size).fill(0.8), new Float32Array(size).fill(angle), new Uint8Array(size).fill(1), seed);
const front = noisy(0, 5).depth;
assert.deepEqual(noisy(0, 5).depth, front);
assert.notDeepEqual(noisy(0, 6).depth, front);
const mean = front.reduce((sum, each) => sum + each, 0) / size;
near(mean, 0.8, 1e-5, "mean");
near(Math.sqrt(front.reduce((sum, each) => sum + (each - mean) ** 2, 0) / size), 0.0015 - 0.0005 * 0.8 + 0.0003 * 0.64, 1e-5, "deviation");
const kept = (degrees) => noisy((degrees * Math.PI) / 180, 5).isObject.reduce((sum, each) => sum + each, 0) / size;
assert.equal(kept(69), 1);
near(kept(77.5), 0.5, 0.01, "share of slanted pixels that are measured");
assert.equal(kept(86), 0);
// Depth jumps: one pixel in five is a mixture, of those beside the other surface.
const halves = new Float32Array(size).map((_, i) => (i % intrinsics.width < intrinsics.width / 2 ? 0.8 : 0.9));
const mixed = withNoise(halves, new Float32Array(size), new Uint8Array(size).fill(1), 5).isObject.reduce((sum, each) => sum + 1 - each, 0);
near(mixed / intrinsics.height, 2 * 0.2 * 0.25, 0.05, "mixed pixels of a row");
assert.ok(withNoise(new Float32Array(size).fill(0.4), new Float32Array(size), new Uint8Array(size), 5).depth.every((each) => each === 0), "nearer than it measures");
console.log("done");
