// The cells: region, workspace and calibration, with a frame of the cell.
import { clone, create, equals } from "@bufbuild/protobuf";
import { Code, ConnectError } from "@connectrpc/connect";
import { Group, Matrix4, Vector3, type Box3, type Object3D } from "three";
import { CellSchema, type Cell } from "../../gen/graspdb/v1/cell_pb";
import type { AxisAlignedBox, Pose } from "../../gen/graspdb/v1/geometry_pb";
import { cells as cellService, listCells, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { boxOfNumbers, BoxFields, draggedBox, PoseFields } from "./cell_fields";
import { facts, h, replace, takeDrops } from "../base/dom";
import { matrixOf, moved, poseOf, poseOfNumbers } from "../base/geometry";
import { readScan, type Scan } from "../files/scan";
import { boxOf } from "../catalogue/stable_pose_points";
import { count, lastPart } from "../base/text";
import { axesObject, emptyPane, heightObject, linesObject, styleColor, Viewer, type DragMode } from "../base/viewer";

const maxFrames = 20;
const colors = { region: "#5b8def", workspace: "#2fbf71" };
const standardRegion = boxOfNumbers([-0.3, -0.3, -0.02, 0.3, 0.3, 0.4]);
const standardWorkspace = boxOfNumbers([-0.4, -0.4, 0, 0.4, 0.4, 0.5]);
// 0.8 m above the table, looking down.
const standardCamera = poseOfNumbers([0, 0, 800, 180, 0, 0]);
const standardBase = poseOfNumbers([-500, 0, 0, 0, 0, 0]);

type Part = "region" | "workspace" | "camera" | "base";
const partNames: Record<Part, string> = { region: "region", workspace: "workspace", camera: "camera", base: "robot base" };
const modeNames: Record<DragMode, string> = { translate: "Move", rotate: "Turn", scale: "Size" };

// The edges of a cube of 1 m about the origin.
function cube(color: string): Object3D {
  const corner = (i: number): number[] => [i & 1, (i >> 1) & 1, (i >> 2) & 1].map((bit) => bit - 0.5);
  const edges = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [1, 2, 4].filter((bit) => (i & bit) === 0).flatMap((bit) => [...corner(i), ...corner(i | bit)]));
  return linesObject(edges, color);
}

// What a camera sees, as far as 0.15 m: its z axis looks forward, y down.
function pyramid(color: string): Object3D {
  const [x, y, z] = [0.09, 0.07, 0.15];
  const corners = [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]];
  return linesObject(corners.flatMap((each, i) => [0, 0, 0, ...each, ...each, ...corners[(i + 1) % 4]!]), color);
}

export class CellView {
  readonly element: HTMLElement;
  private readonly viewer = new Viewer("The cell", (key) => this.selectPart(key as Part));
  private readonly select = h("select", { id: "cell-name", onchange: () => this.take(this.cells.find((each) => each.name === this.select.value), true) });
  private readonly newId = h("input", { type: "text", id: "cell-new", spellcheck: false });
  private readonly region = new BoxFields("cell-region", "region", standardRegion, () => this.changed());
  private readonly workspace = new BoxFields("cell-workspace", "workspace of the tool", standardWorkspace, () => this.changed());
  private readonly camera = new PoseFields("cell-camera", "camera in the world frame", standardCamera, () => this.changed());
  private readonly flange = new PoseFields("cell-flange", "camera on the robot's flange", poseOfNumbers([0, 0, 0, 0, 0, 0]), () => this.changed());
  private readonly base = new PoseFields("cell-base", "robot base in the world frame", standardBase, () => this.changed());
  private readonly labels = h("input", { type: "text", id: "cell-labels", spellcheck: false, oninput: () => this.changed() });
  private readonly drafts = h("input", { type: "checkbox", id: "cell-drafts", onchange: () => this.changed() });
  private readonly saveButton = h("button", { type: "button", className: "primary", onclick: () => void this.save(this.loaded?.etag ?? "") }, "Save the cell");
  private readonly discardButton = h("button", { type: "button", onclick: () => this.take(this.loaded, false) }, "Discard the changes");
  private readonly state = h("p", { className: "hint", role: "status" });
  private readonly conflict = h("div", { className: "advice conflict", role: "alert", hidden: true });
  private readonly frames = h("div", { className: "answers" });
  private readonly pipeline = h("div", {});
  private readonly tools = h("div", { className: "poses", role: "group", "aria-label": "What to drag, and how" });
  private cells: Cell[] = [];
  private loaded: Cell | undefined;
  private scans: Scan[] = [];
  private shown: Scan | undefined;
  private part: Part = "region";
  private mode: DragMode = "translate";

  constructor(private readonly report: (error: Explained | undefined) => void, private readonly use: (scan: Scan) => void) {
    const input = h("input", {
      type: "file", id: "cell-files", multiple: true, accept: ".bundle,.pcd,.ply,.png,.json",
      onchange: () => void this.open([...(input.files ?? [])]),
    });
    this.element = h("div", { className: "scene cells" },
      h("aside", { "aria-label": "Cells and frames" },
        h("div", { className: "field" }, h("label", { for: "cell-name" }, "cell"), this.select),
        h("details", {}, h("summary", {}, "New cell"), h("div", { className: "field" }, h("label", { for: "cell-new" }, "id"), this.newId),
          h("button", { type: "button", onclick: () => void this.create() }, "Create")),
        this.saveButton, this.discardButton, this.state, this.conflict,
        h("label", { className: "drop", for: input.id }, h("strong", {}, "Drop frames of the cell"),
          h("span", {}, "bundles of its black box, PCD, PLY, or a 16-bit PNG with intrinsics.json"), input),
        this.frames),
      h("div", { className: "stage" }, this.tools, this.viewer.element),
      h("aside", { className: "right", "aria-label": "The cell's settings" },
        this.region.element, this.workspace.element, this.camera.element, this.flange.element, this.base.element,
        h("div", { className: "field" }, h("label", { for: "cell-labels" }, "labels, separated by commas"), this.labels),
        h("div", { className: "field" }, h("label", { for: "cell-drafts" }, "recognises drafts"), this.drafts), this.pipeline));
    takeDrops(this.element, (files) => void this.open(files));
  }

  opened(): void {
    this.viewer.draw();
    if (!this.isChanged()) void this.attempt(() => this.load(this.select.value));
  }

  recolour(): void {
    this.draw(false);
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action, "This cannot be used");
  }

  private async load(name: string): Promise<void> {
    this.cells = await listCells(1000);
    replace(this.select, this.cells.map((each) => h("option", { value: each.name }, each.displayName || lastPart(each.name))));
    this.take(this.cells.find((each) => each.name === name) ?? this.cells[0], this.loaded === undefined);
  }

  private create(): Promise<void> {
    return this.attempt(async () => {
      this.report(undefined);
      const made = await cellService.createCell({ cellId: this.newId.value, cell: {} });
      this.newId.value = "";
      await this.load(made.name);
    });
  }

  // A cell as the server has it.
  private take(cell: Cell | undefined, look: boolean): void {
    this.conflict.hidden = true;
    if (cell) this.cells = this.cells.map((each) => each.name === cell.name ? cell : each);
    this.loaded = cell;
    this.select.value = cell?.name ?? "";
    this.region.set(cell?.regionOfInterest);
    this.workspace.set(cell?.workspace);
    this.camera.set(cell?.sensorPose);
    this.flange.set(cell?.flangeSensorPose);
    this.base.set(cell?.robotBasePose);
    this.labels.value = cell?.labels.join(", ") ?? "";
    this.drafts.checked = cell?.includeDrafts ?? false;
    const settings = Object.entries(cell?.pipeline ?? {}).filter(([key, value]) => !key.startsWith("$") && value !== undefined);
    replace(this.pipeline, h("h2", {}, "Pipeline"), settings.length > 0
      ? facts(settings.map(([key, value]) => [key, String(value)])) : h("p", { className: "hint" }, "The server's defaults."),
    h("p", { className: "hint" }, "The scene's parameters are saved to a cell in the view Scene."));
    this.changed();
    if (look) this.draw(true);
  }

  // As it is in the form.
  private edited(): Cell | undefined {
    if (!this.loaded) return undefined;
    const out = clone(CellSchema, this.loaded);
    out.regionOfInterest = this.region.get();
    out.workspace = this.workspace.get();
    out.sensorPose = this.camera.get();
    out.flangeSensorPose = this.flange.get();
    out.robotBasePose = this.base.get();
    out.labels = this.labels.value.split(",").map((each) => each.trim()).filter((each) => each !== "");
    out.includeDrafts = this.drafts.checked;
    return out;
  }

  private isChanged(): boolean {
    const edited = this.edited();
    return edited !== undefined && !equals(CellSchema, edited, this.loaded!);
  }

  private changed(): void {
    const isChanged = this.isChanged();
    this.saveButton.disabled = this.discardButton.disabled = !isChanged;
    this.select.disabled = isChanged;
    replace(this.state, isChanged ? "Not saved." : this.loaded ? "" : "There is no cell: create one.");
    this.draw(false);
  }

  private async save(etag: string): Promise<void> {
    const edited = this.edited();
    if (!edited) return;
    this.report(undefined);
    this.conflict.hidden = true;
    await this.attempt(async () => {
      try {
        const saved = await cellService.updateCell({
          cell: create(CellSchema, { ...edited, etag }),
          updateMask: { paths: ["sensor_pose", "region_of_interest", "workspace", "robot_base_pose", "flange_sensor_pose", "labels", "include_drafts"] },
        });
        this.take(saved, false);
        replace(this.state, "Saved. The cell's agent uses it within seconds.");
      } catch (error) {
        if (ConnectError.from(error).code !== Code.Aborted) throw error;
        this.showConflict(await cellService.getCell({ name: edited.name }));
      }
    });
  }

  private showConflict(theirs: Cell): void {
    replace(this.conflict,
      h("p", {}, h("strong", {}, "Not saved: "), `${lastPart(theirs.name)} was changed since you loaded it (ABORTED).`),
      h("p", {}, h("strong", {}, "Next step: "), "Take theirs and repeat your changes, or replace theirs by yours. Its pipeline stays theirs."),
      h("div", { className: "row" },
        h("button", { type: "button", onclick: () => this.take(theirs, false) }, "Take theirs"),
        h("button", { type: "button", onclick: () => void this.save(theirs.etag) }, "Replace theirs")));
    this.conflict.hidden = false;
  }

  private open(files: File[]): Promise<void> {
    return this.attempt(async () => {
      this.report(undefined);
      const bundles = files.filter((each) => /\.bundle$/i.test(each.name)).sort((a, b) => b.name.localeCompare(a.name));
      const scans: Scan[] = [];
      // The newest first; their names begin with their numbers.
      for (const file of bundles.slice(0, maxFrames)) scans.push(await readScan([file]));
      if (bundles.length === 0) scans.push(await readScan(files));
      this.scans = scans;
      this.shown = scans[0];
      const name = this.shown?.recorded?.cell;
      const isKnown = this.cells.some((each) => each.name === name);
      if (name !== undefined && isKnown && !this.isChanged()) this.take(await cellService.getCell({ name }), false);
      this.updateFrames();
      this.draw(true);
    });
  }

  private updateFrames(): void {
    replace(this.frames, this.scans.map((each) => h("div", { className: "row" },
      h("button", {
        type: "button", className: "pick", "aria-pressed": each === this.shown, onclick: () => {
          this.shown = each;
          this.updateFrames();
          this.draw(false);
        },
      }, each.recorded ? `${each.recorded.time} · ${each.recorded.outcome}` : each.name,
      h("small", {}, each.recorded ? `${lastPart(each.recorded.cell) || "no cell"}${each.recorded.robot ? `, ${each.recorded.robot}` : ""}` : "", ` ${count(each.points.length / 3)} points`)),
      h("button", { type: "button", className: "beside", title: "Open it in the scene", onclick: () => this.use(each) }, "open"))));
  }

  private selectPart(part: Part): void {
    this.part = part;
    this.draw(false);
  }

  private modes(): DragMode[] {
    return this.part === "camera" || this.part === "base" ? ["translate", "rotate"] : ["translate", "scale"];
  }

  // T_world_sensor of the shown frame: of the form, so that one sees what a change does; else of the frame.
  private framePose(): Pose | undefined {
    return this.camera.get() ?? this.shown?.sensorPose;
  }

  private draw(look: boolean): void {
    const pane = emptyPane();
    const points = this.shown ? moved(this.shown.points, matrixOf(this.framePose())) : new Float32Array();
    if (points.length > 0) pane.content.add(heightObject(points, 0.006, 0.15, 1.5));
    pane.content.add(axesObject(new Matrix4(), 0.1));
    const handles: Partial<Record<Part, Object3D>> = {};
    // The label is away from the handle, which is at the part's middle.
    const add = (part: Part, drawn: Object3D, label: Vector3): void => {
      handles[part] = drawn;
      pane.content.add(drawn);
      if (part !== this.part) pane.labels.push({ at: label, text: partNames[part], key: part, tone: "ok" });
    };
    for (const part of ["region", "workspace"] as const) {
      const box = this[part].get();
      if (!box?.min || !box.max) continue;
      const group = new Group();
      const [min, max] = [new Vector3(box.min.x, box.min.y, box.min.z), new Vector3(box.max.x, box.max.y, box.max.z)];
      group.position.addVectors(min, max).multiplyScalar(0.5);
      group.scale.subVectors(max, min);
      group.add(cube(colors[part]));
      add(part, group, new Vector3(min.x, min.y, max.z));
    }
    for (const part of ["camera", "base"] as const) {
      const pose = this[part].get();
      if (!pose) continue;
      const group = new Group();
      matrixOf(pose).decompose(group.position, group.quaternion, group.scale);
      group.add(axesObject(new Matrix4(), part === "base" ? 0.15 : 0.05));
      if (part === "camera") group.add(pyramid(styleColor("--accent")));
      add(part, group, group.position.clone());
    }
    this.viewer.show([pane]);
    const handle = handles[this.part];
    if (!this.modes().includes(this.mode)) this.mode = "translate";
    if (handle) this.viewer.handle(handle, this.mode, "world", (ended) => this.dragged(handle, ended));
    this.updateTools(handles);
    if (look) this.viewer.look(this.lookBox(points));
  }

  private lookBox(points: Float32Array): Box3 {
    const box = this.region.get() ?? this.workspace.get() ?? standardRegion;
    const out = boxOf([new Float32Array([box.min!.x, box.min!.y, box.min!.z, box.max!.x, box.max!.y, box.max!.z])]);
    const camera = this.camera.get()?.position;
    if (camera) out.expandByPoint(new Vector3(camera.x, camera.y, camera.z));
    return points.length > 0 && !this.framePose() ? boxOf([points]) : out;
  }

  private updateTools(handles: Partial<Record<Part, Object3D>>): void {
    const button = (text: string, pressed: boolean, disabled: boolean, press: () => void): HTMLElement =>
      h("button", { type: "button", "aria-pressed": pressed, disabled, onclick: () => {
        press();
        this.draw(false);
      } }, text);
    replace(this.tools,
      (Object.keys(partNames) as Part[]).map((part) => button(partNames[part], part === this.part, handles[part] === undefined, () => (this.part = part))),
      h("span", { className: "gap" }),
      this.modes().map((mode) => button(modeNames[mode], mode === this.mode, handles[this.part] === undefined, () => (this.mode = mode))));
  }

  private dragged(handle: Object3D, ended: boolean): void {
    handle.updateMatrix();
    if (this.part === "camera" || this.part === "base") this[this.part].set(poseOf(handle.matrix));
    else this[this.part].set(draggedBox(handle.position.toArray(), handle.scale.toArray()) as AxisAlignedBox);
    if (ended) this.changed();
  }
}
