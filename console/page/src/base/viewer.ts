// One or two scenes side by side, seen by one camera. Draws when something changes.
import {
  AxesHelper, Box3, Box3Helper, BufferAttribute, BufferGeometry, Color, GridHelper, Group, LineBasicMaterial, LineSegments, Matrix4, PerspectiveCamera,
  Points as PointsObject, PointsMaterial, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { h } from "./dom";
import type { Points } from "./geometry";

// What is drawn of one side. `pick`: called with the key of a clicked object.
export interface Pane { content: Group; labels: { at: Vector3; text: string; key: string; tone: string }[]; title: string }

export function emptyPane(title = ""): Pane {
  return { content: new Group(), labels: [], title };
}

// Points of one colour, metres.
export function cloudObject(points: Points, color: string, size: number, key = ""): PointsObject {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const out = new PointsObject(geometry, new PointsMaterial({ color: new Color(color), size, sizeAttenuation: false }));
  out.userData.key = key;
  return out;
}

// Points coloured by their height above the table: what lies on it is brighter. `low` and `high`: metres.
export function heightObject(points: Points, low: number, high: number, size: number): PointsObject {
  const table = new Color(styleColor("--table"));
  const bottom = new Color(styleColor("--low"));
  const top = new Color(styleColor("--high"));
  const colors = new Float32Array(points.length);
  const color = new Color();
  for (let i = 0; i < points.length; i += 3) {
    const z = points[i + 2]!;
    if (z < low - 1e-6) color.copy(table);
    else color.lerpColors(bottom, top, Math.min(1, (z - low) / Math.max(1e-6, high - low)));
    color.toArray(colors, i);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
  return new PointsObject(geometry, new PointsMaterial({ vertexColors: true, size, sizeAttenuation: false }));
}

// A colour of the style sheet, which has those of light and dark; drawn objects keep theirs.
export const styleColor = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export function linesObject(vertices: number[], color: string): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(vertices), 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: new Color(color) }));
}

// A point that can be clicked.
export function handleObject(at: Vector3, key: string, color: string): PointsObject {
  return cloudObject(new Float32Array(at.toArray()), color, 7, key);
}

export function boxObject(min: Vector3, max: Vector3, color: string): Object3D {
  return new Box3Helper(new Box3(min, max), new Color(color));
}

export function axesObject(matrix: Matrix4, size: number): Object3D {
  const out = new AxesHelper(size);
  out.applyMatrix4(matrix);
  return out;
}

// A gripper of two parallel fingers at T_world_tcp: its z axis points along the approach, its x axis along the
// closing direction.
export function gripperObject(tcp: Matrix4, opening: number, approach: number, color: string): Object3D {
  const half = Math.max(opening, 0.004) / 2;
  const finger = 0.03;
  const palm = finger + 0.012;
  const out = linesObject([
    -half, 0, 0, -half, 0, -finger, half, 0, 0, half, 0, -finger, -half, 0, -finger, half, 0, -finger,
    0, 0, -finger, 0, 0, -Math.max(palm, approach),
    -0.004, 0, 0, 0.004, 0, 0, 0, -0.004, 0, 0, 0.004, 0,
  ], color);
  out.applyMatrix4(tcp);
  return out;
}

export type DragMode = "translate" | "rotate" | "scale";

function dispose(group: Object3D): void {
  group.traverse((each) => {
    const drawn = each as Partial<PointsObject>;
    drawn.geometry?.dispose();
    const material = drawn.material;
    (Array.isArray(material) ? material : material ? [material] : []).forEach((one) => one.dispose());
  });
}

export class Viewer {
  readonly element: HTMLElement;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly overlay = h("div", { className: "labels" });
  private panes: Pane[] = [emptyPane()];
  private scenes: Scene[] = [];
  private isDrawn = true;
  private drag: TransformControls | undefined;
  private onDrag: (ended: boolean) => void = () => {};

  constructor(label: string, private readonly pick: (key: string) => void) {
    const canvas = h("canvas", { tabIndex: 0, role: "img" });
    canvas.setAttribute("aria-label", `${label}. Drag to turn, arrow keys to move, plus and minus to zoom.`);
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setScissorTest(true);
    this.element = h("div", { className: "viewer" }, canvas, this.overlay);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0.5, -0.9, 0.7);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.element);
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) < 4) this.click(event);
    });
  }

  show(panes: Pane[]): void {
    this.drag?.detach();
    this.panes.forEach((pane) => dispose(pane.content));
    this.panes = panes;
    this.scenes = panes.map((pane) => {
      const scene = new Scene();
      scene.add(pane.content);
      const grid = new GridHelper(1, 10, "#7a8594", "#7a8594");
      grid.rotateX(Math.PI / 2);
      const material = grid.material as LineBasicMaterial;
      material.transparent = true;
      material.opacity = 0.25;
      scene.add(grid);
      return scene;
    });
    this.draw();
  }

  // Lets a person move, turn or scale `object`, which is in the only pane, along its own axes or those of the world. `onDrag` is
  // called after each step and, with true, at the end.
  handle(object: Object3D, mode: DragMode, space: "local" | "world", onDrag: (ended: boolean) => void): void {
    this.drag ??= this.makeDrag();
    this.drag.setMode(mode);
    this.drag.setSpace(space);
    this.drag.attach(object);
    this.scenes[0]?.add(this.drag.getHelper());
    this.onDrag = onDrag;
    this.draw();
  }

  private makeDrag(): TransformControls {
    const out = new TransformControls(this.camera, this.renderer.domElement);
    out.setSize(0.7);
    out.addEventListener("change", () => this.draw());
    out.addEventListener("objectChange", () => this.onDrag(false));
    out.addEventListener("dragging-changed", (event) => {
      this.controls.enabled = event.value !== true;
      if (this.controls.enabled) this.onDrag(true);
    });
    return out;
  }

  // Looks at the box from the given direction.
  look(box: Box3, from = new Vector3(0.45, -0.9, 0.75)): void {
    if (box.isEmpty()) return;
    const center = box.getCenter(new Vector3());
    const distance = Math.max(0.1, box.getSize(new Vector3()).length() * 1.25);
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(from.clone().normalize(), distance);
    this.controls.update();
    this.draw();
  }

  draw(): void {
    if (!this.isDrawn) return;
    this.isDrawn = false;
    requestAnimationFrame(() => {
      this.isDrawn = true;
      this.drawNow();
    });
  }

  private drawNow(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.renderer.setClearColor(new Color(styleColor("--scene")));
    this.overlay.textContent = "";
    const share = width / this.scenes.length;
    this.camera.aspect = share / height;
    this.camera.updateProjectionMatrix();
    this.scenes.forEach((scene, i) => {
      this.renderer.setViewport(i * share, 0, share, height);
      this.renderer.setScissor(i * share, 0, share, height);
      this.renderer.render(scene, this.camera);
      this.label(this.panes[i]!, i * share, share, height);
    });
  }

  private label(pane: Pane, left: number, width: number, height: number): void {
    if (pane.title !== "") {
      const title = h("div", { className: "pane-title" }, pane.title);
      title.style.left = `${left + 10}px`;
      this.overlay.append(title);
    }
    for (const label of pane.labels) {
      const at = label.at.clone().project(this.camera);
      if (at.z > 1 || Math.abs(at.x) > 1 || Math.abs(at.y) > 1) continue;
      const button = h("button", { type: "button", className: `label ${label.tone}`, onclick: () => this.pick(label.key) }, label.text);
      button.style.left = `${left + ((at.x + 1) / 2) * width}px`;
      button.style.top = `${((1 - at.y) / 2) * height}px`;
      this.overlay.append(button);
    }
  }

  private click(event: PointerEvent): void {
    const { width, height, left, top } = this.element.getBoundingClientRect();
    const share = width / this.scenes.length;
    const x = event.clientX - left;
    const i = Math.min(this.scenes.length - 1, Math.floor(x / share));
    const ray = new Raycaster();
    ray.params.Points.threshold = 0.005;
    ray.setFromCamera(new Vector2(((x - i * share) / share) * 2 - 1, 1 - ((event.clientY - top) / height) * 2), this.camera);
    const pane = this.panes[i];
    if (!pane) return;
    const keyed: Object3D[] = [];
    pane.content.traverse((each) => {
      if (typeof each.userData.key === "string" && each.userData.key !== "") keyed.push(each);
    });
    const hit = ray.intersectObjects(keyed, false)[0];
    if (hit) this.pick(hit.object.userData.key as string);
  }

  private onKey(event: KeyboardEvent): void {
    const factor = event.key === "+" || event.key === "=" ? 0.85 : event.key === "-" ? 1 / 0.85 : 0;
    if (factor === 0) return;
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }
}
