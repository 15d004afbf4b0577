// A simulated depth camera, drawn by WebGL: the Kinect v2 of rendering/camera/depth_camera.cc with its noise, as `graspdb teach --mesh` takes
// by default. Sensor frame: x right, y down, z forward; metres.
import {
  BufferAttribute, BufferGeometry, Camera, DoubleSide, FloatType, Matrix4, Mesh, NearestFilter, NoBlending, PlaneGeometry, RGBAFormat, Scene, ShaderMaterial,
  Vector3, WebGLRenderer, WebGLRenderTarget,
} from "three";
import type { TriangleMesh } from "./triangle_mesh";

export const intrinsics = { width: 512, height: 424, fx: 365.5, fy: 365.5, cx: 255.5, cy: 211.5 };
export const minDepth = 0.5;
export const maxDepth = 4.5;
const tableHalfWidth = 1;

// Row by row. `depth` 0: not measured. `isObject`: the pixel shows the object, and neither the table nor a mixture of both.
export interface DepthFrame { depth: Float32Array; isObject: Uint8Array }

const vertexShader = `
varying vec3 at;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  at = seen.xyz;
  gl_Position = projectionMatrix * seen;
}`;

// Depth, angle between ray and normal, and the surface.
const fragmentShader = `
uniform float surface;
varying vec3 at;
void main() {
  vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
  gl_FragColor = vec4(at.z, acos(min(1.0, abs(dot(normal, normalize(at))))), surface, 1.0);
}`;

const objectSurface = 1;
const tableSurface = 2;

const materialOf = (surface: number): ShaderMaterial =>
  new ShaderMaterial({ vertexShader, fragmentShader, uniforms: { surface: { value: surface } }, side: DoubleSide, blending: NoBlending });

// Points of the sensor frame on the picture, whose rows go upwards in WebGL; the middle of a pixel is its whole number.
function projection(): Matrix4 {
  const { width, height, fx, fy, cx, cy } = intrinsics;
  const [near, far] = [0.05, 2 * maxDepth];
  return new Matrix4().set(
    (2 * fx) / width, 0, (2 * cx + 1) / width - 1, 0,
    0, (-2 * fy) / height, 1 - (2 * cy + 1) / height, 0,
    0, 0, (far + near) / (far - near), (-2 * far * near) / (far - near),
    0, 0, 1, 0);
}

// T_world_sensor of a level camera that looks at the origin from `distance` away, down by `lookDown` and from the side `azimuth`, rad.
export function lookAt(distance: number, lookDown: number, azimuth: number): Matrix4 {
  const away = new Vector3(Math.cos(lookDown) * Math.cos(azimuth), Math.cos(lookDown) * Math.sin(azimuth), Math.sin(lookDown));
  const forward = away.clone().negate();
  const right = new Vector3(-Math.sin(azimuth), Math.cos(azimuth), 0);
  return new Matrix4().makeBasis(right, forward.clone().cross(right), forward).setPosition(away.multiplyScalar(distance));
}

// A whole number of 32 bits that depends on both.
export function randomBits(seed: number, counter: number): number {
  let x = (seed ^ counter) >>> 0;
  x = Math.imul(x ^ (x >>> 16), 0x7feb352d);
  x = Math.imul(x ^ (x >>> 15), 0x846ca68b);
  return (x ^ (x >>> 16)) >>> 0;
}

// In [0, 1).
const uniform = (seed: number, counter: number): number => randomBits(seed, counter) / 4294967296;
const gaussian = (seed: number, counter: number): number =>
  Math.sqrt(-2 * Math.log(1 - uniform(seed, 2 * counter))) * Math.cos(2 * Math.PI * uniform(seed, 2 * counter + 1));

// Standard deviation, for a depth and the angle between ray and normal (Fankhauser and others, "Kinect v2 for Mobile Robot Navigation", 2015).
function deviation(depth: number, angle: number): number {
  const ratio = angle / Math.max(1e-6, Math.PI / 2 - angle);
  return Math.min(0.05, 0.0015 - 0.0005 * depth + 0.0003 * depth * depth + 0.0001 * depth ** 1.5 * ratio * ratio);
}

const dropoutBegin = (70 * Math.PI) / 180;
const dropoutEnd = (85 * Math.PI) / 180;
const flyingChance = 0.2;
const flyingJump = 0.02;

// Seeds of independent random numbers for one frame.
const seedsOf = (seed: number): Record<"axial" | "dropout" | "chance" | "neighbour" | "share", number> => ({
  axial: randomBits(seed, 1), dropout: randomBits(seed, 2), chance: randomBits(seed, 3), neighbour: randomBits(seed, 4), share: randomBits(seed, 5),
});

// Pixels on a depth jump that lie between both surfaces.
function mixEdges(ideal: Float32Array, frame: DepthFrame, seed: number): void {
  const { width, height } = intrinsics;
  const seeds = seedsOf(seed);
  const steps = [[1, 0], [-1, 0], [0, 1], [0, -1]] as const;
  for (let i = 0; i < ideal.length; ++i) {
    if (!(ideal[i]! > 0) || uniform(seeds.chance, i) >= flyingChance) continue;
    const [du, dv] = steps[randomBits(seeds.neighbour, i) % 4]!;
    const [u, v] = [(i % width) + du, Math.floor(i / width) + dv];
    if (u < 0 || v < 0 || u >= width || v >= height) continue;
    const beside = ideal[v * width + u]!;
    if (!(beside > 0) || Math.abs(beside - ideal[i]!) <= flyingJump) continue;
    const share = uniform(seeds.share, i);
    frame.depth[i] = (1 - share) * ideal[i]! + share * beside;
    frame.isObject[i] = 0;
  }
}

// The frame of an ideal camera with the noise of a real one. `angles`: between ray and normal.
export function withNoise(ideal: Float32Array, angles: Float32Array, isObject: Uint8Array, seed: number): DepthFrame {
  const out = { depth: ideal.slice(), isObject: isObject.slice() };
  const seeds = seedsOf(seed);
  mixEdges(ideal, out, seed);
  for (let i = 0; i < ideal.length; ++i) {
    const depth = out.depth[i]!;
    if (!(depth > 0)) continue;
    const angle = angles[i]!;
    const noisy = depth + deviation(depth, angle) * gaussian(seeds.axial, i);
    const isLost = angle >= dropoutEnd || (angle > dropoutBegin && uniform(seeds.dropout, i) < (angle - dropoutBegin) / (dropoutEnd - dropoutBegin));
    out.depth[i] = isLost || noisy < minDepth || noisy > maxDepth ? 0 : noisy;
    if (out.depth[i] === 0) out.isObject[i] = 0;
  }
  return out;
}

// Draws a mesh on a table. Dispose of it: browsers have few contexts.
export class DepthCamera {
  private readonly renderer = new WebGLRenderer({ canvas: new OffscreenCanvas(intrinsics.width, intrinsics.height) });
  private readonly target: WebGLRenderTarget;
  private readonly scene = new Scene();
  private readonly camera = new Camera();
  private readonly object = new Mesh(new BufferGeometry(), materialOf(objectSurface));
  private readonly table = new Mesh(new PlaneGeometry(2 * tableHalfWidth, 2 * tableHalfWidth), materialOf(tableSurface));

  // Throws where the browser cannot draw numbers.
  constructor() {
    if (!this.renderer.extensions.has("EXT_color_buffer_float")) {
      this.dispose();
      throw new Error("this browser's WebGL cannot draw depths (EXT_color_buffer_float); use another browser, or graspdb teach OBJECT --mesh FILE");
    }
    this.target = new WebGLRenderTarget(intrinsics.width, intrinsics.height,
      { type: FloatType, format: RGBAFormat, minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false });
    for (const each of [this.object, this.table]) {
      each.frustumCulled = false;
      each.matrixAutoUpdate = false;
      this.scene.add(each);
    }
    this.camera.matrixAutoUpdate = false;
    this.camera.projectionMatrix.copy(projection());
    this.camera.projectionMatrixInverse.copy(projection()).invert();
    this.renderer.setClearColor(0, 0);
  }

  // The object of the next frames.
  show(mesh: TriangleMesh): void {
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute("position", new BufferAttribute(mesh.vertices, 3));
    this.object.geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
  }

  // The same arguments give the same frame in one browser.
  frame(worldObject: Matrix4, worldSensor: Matrix4, seed: number): DepthFrame {
    this.object.matrix.copy(worldObject);
    this.camera.matrix.copy(worldSensor);
    this.object.matrixWorldNeedsUpdate = true;
    this.camera.matrixWorldNeedsUpdate = true;
    this.renderer.setRenderTarget(this.target);
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    const { width, height } = intrinsics;
    const pixels = new Float32Array(4 * width * height);
    this.renderer.readRenderTargetPixels(this.target, 0, 0, width, height, pixels);
    const depth = new Float32Array(width * height);
    const angles = new Float32Array(width * height);
    const isObject = new Uint8Array(width * height);
    for (let v = 0; v < height; ++v) {
      for (let u = 0; u < width; ++u) {
        const from = 4 * ((height - 1 - v) * width + u);
        const to = v * width + u;
        depth[to] = pixels[from]!;
        angles[to] = pixels[from + 1]!;
        isObject[to] = Number(pixels[from + 2] === objectSurface);
      }
    }
    return withNoise(depth, angles, isObject, seed);
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.table.geometry.dispose();
    this.target?.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
