// Teaching from captures: they are drawn, stored as a draft, drawn as the server has them, and released.
import { Matrix4 } from "three";
import type { Cell } from "../../gen/graspdb/v1/cell_pb";
import type { StablePose, View } from "../../gen/graspdb/v1/catalog_pb";
import type { AxisAlignedBox, Pose } from "../../gen/graspdb/v1/geometry_pb";
import { explain, listCells, listViews, uploadView, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { showCells } from "../base/cell_options";
import { h, replace } from "../base/dom";
import type { Points } from "../base/geometry";
import { boxOf, pointsInObjectFrame, viewsToDraw } from "../catalogue/stable_pose_points";
import { readCaptures, shownPoints, turnedPose, viewIdOf, type Captures } from "./teach_captures";
import { deleteDrafts, makeDraft, releaseDraft } from "./teach_draft";
import { count, lastPart } from "../base/text";
import { axesObject, cloudObject, emptyPane, heightObject, styleColor, Viewer } from "../base/viewer";

const maxViews = 500;

export class TeachView {
  readonly element: HTMLElement;
  private readonly viewer = new Viewer("The captures", (key) => this.select(Number(key)));
  private readonly object = this.text("teach-object");
  private readonly displayName = this.text("teach-name");
  private readonly pose = this.text("teach-pose");
  private readonly symmetry = this.number("teach-symmetry", "1");
  private readonly cell = h("select", { id: "teach-cell", onchange: () => this.updateCaptures(true) });
  private readonly segmented = h("input", { type: "checkbox", id: "teach-segmented", onchange: () => this.updateCaptures(true) });
  private readonly step = this.number("teach-step", "");
  private readonly x = this.number("teach-x", "0");
  private readonly y = this.number("teach-y", "0");
  private readonly captureList = h("div", { className: "answers" });
  private readonly storeButton = h("button", { type: "submit", className: "primary", disabled: true }, "Store as a draft");
  private readonly panel = h("div", { className: "panel" });
  private readonly progress = h("p", { role: "status" });
  private readonly title = h("div", { className: "poses" });
  private cells: Cell[] = [];
  private files: Captures | undefined;
  private selected = -1;
  private draft: StablePose | undefined;
  private refusals: [string, Explained][] = [];
  private stored: View[] = [];
  private isBusy = false;
  private drawing = 0;

  // `drop`: the element that takes files, whose owner opens them.
  constructor(private readonly report: (error: Explained | undefined) => void, drop: HTMLElement) {
    const field = (element: HTMLElement, label: string, unit = ""): HTMLElement => h("div", { className: "field" },
      h("label", { for: element.id }, label), element, unit !== "" && h("span", { className: "unit" }, unit));
    const form = h("form", {
      noValidate: true, onsubmit: (event: Event) => {
        event.preventDefault();
        void this.store();
      },
    },
    field(this.object, "object id"), field(this.displayName, "its name"), field(this.pose, "stable pose id"),
    field(this.symmetry, "symmetry: n-fold, 0: any turn"),
    field(this.cell, "cell"), field(this.segmented, "the object's points alone"),
    h("h2", {}, "Turntable"),
    h("p", { className: "hint" }, "Captures in the order of their names. Without a step each one is a view of its own, put where its points are."),
    field(this.step, "step, counter-clockwise", "°"), field(this.x, "axis at x", "mm"), field(this.y, "axis at y", "mm"),
    this.captureList, this.storeButton);
    this.element = h("div", { className: "scene teach" },
      h("aside", { "aria-label": "Captures" }, drop, form),
      h("div", { className: "stage" }, this.title, this.viewer.element),
      h("aside", { className: "right", "aria-label": "Draft" }, this.progress, this.panel));
    this.updatePanel();
  }

  private text(id: string): HTMLInputElement {
    return h("input", { id, type: "text", spellcheck: false, autocomplete: "off" });
  }

  private number(id: string, value: string): HTMLInputElement {
    return h("input", { id, type: "number", step: "any", value, oninput: () => this.updateCaptures(false) });
  }

  opened(): void {
    this.viewer.draw();
    void this.attempt(async () => {
      this.cells = await listCells(1000);
      showCells(this.cell, this.cells);
    });
  }

  recolour(): void {
    void this.draw(false);
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action, "This cannot be taught");
  }

  open(files: File[]): Promise<void> {
    return this.attempt(async () => {
      this.report(undefined);
      this.files = await readCaptures(files);
      this.draft = undefined;
      this.stored = [];
      this.refusals = [];
      this.selected = -1;
      if (this.files.objectId) this.object.value = this.files.objectId;
      if (this.files.displayName) this.displayName.value = this.files.displayName;
      if (this.files.stablePose) {
        this.pose.value = this.files.stablePose.stablePoseId;
        this.symmetry.value = String(this.files.stablePose.symmetryOrder ?? 1);
      }
      this.segmented.checked = this.files.captures.every((each) => each.scan.segmented);
      this.updateCaptures(true);
      this.updatePanel();
    });
  }

  private region(): AxisAlignedBox | undefined {
    return this.files?.region ?? this.cells.find((each) => each.name === this.cell.value)?.regionOfInterest;
  }

  // T_world_sensor: of the file, else of the cell.
  private sensorPose(i: number): Pose | undefined {
    return this.files?.captures[i]?.scan.sensorPose ?? this.cells.find((each) => each.name === this.cell.value)?.sensorPose;
  }

  private objectPose(i: number): Pose | undefined {
    const own = this.files?.captures[i]?.objectPose;
    const [step, x, y] = [this.step, this.x, this.y].map((input) => input.valueAsNumber);
    return own ?? (Number.isFinite(step) ? turnedPose((x || 0) / 1000, (y || 0) / 1000, i * step!) : undefined);
  }

  private select(i: number): void {
    this.selected = i === this.selected ? -1 : i;
    this.updateCaptures(false);
  }

  private updateCaptures(look: boolean): void {
    const captures = this.files?.captures ?? [];
    replace(this.captureList, captures.length > 0 && h("h2", {}, `${captures.length} capture${captures.length === 1 ? "" : "s"}`),
      this.files?.leftOut && h("p", { className: "hint" }, `Left out: ${this.files.leftOut}.`),
      captures.map((each, i) => h("div", { className: "row" },
        h("button", { type: "button", className: "pick", "aria-pressed": i === this.selected, onclick: () => this.select(i) }, each.scan.name,
          h("small", {}, `${count(each.scan.points.length / 3)} points, ${this.sensorPose(i) ? "sensor pose known" : "no sensor pose"}${this.objectPose(i) ? ", object pose known" : ""}`)),
        h("button", { type: "button", className: "beside", title: `Leave out ${each.scan.name}`, disabled: this.draft !== undefined, onclick: () => {
          captures.splice(i, 1);
          this.selected = -1;
          this.updateCaptures(true);
        } }, "leave out"))));
    this.storeButton.disabled = captures.length === 0 || this.isBusy;
    void this.draw(look);
  }

  private async store(): Promise<void> {
    const files = this.files;
    if (!files || this.isBusy) return;
    this.isBusy = true;
    this.storeButton.disabled = true;
    this.refusals = [];
    this.report(undefined);
    await this.attempt(async () => {
      if (this.object.value === "" || this.pose.value === "") throw new Error("give the ids of the object and of its stable pose");
      const [step, symmetry] = [this.step, this.symmetry].map((input) => input.valueAsNumber);
      if (Number.isFinite(step) && files.captures.some((_, i) => !this.sensorPose(i))) {
        throw new Error("a turntable needs the sensor's pose: choose the cell, or drop files that have it");
      }
      ({ draft: this.draft } = await makeDraft({
        objectId: this.object.value, displayName: this.displayName.value, stablePoseId: this.pose.value,
        symmetryOrder: Number.isInteger(symmetry) ? symmetry! : 1, grasps: files.stablePose?.grasps ?? [],
      }));
      for (const [i, { scan }] of files.captures.entries()) {
        replace(this.progress, `${i + 1} of ${files.captures.length}: ${scan.name}`);
        try {
          await uploadView({
            parent: this.draft.name, viewId: await viewIdOf(scan), regionOfInterest: this.region(),
            view: {
              ...(scan.message.case === "cloud" ? { cloud: scan.message.value } : { depthImage: scan.message.value }),
              sensorPose: this.sensorPose(i), objectPose: this.objectPose(i), segmented: this.segmented.checked,
            },
          });
        } catch (error) {
          const explained = explain(error);
          if (explained.needsToken) throw error;
          this.refusals.push([scan.name, explained]);
        }
      }
      this.stored = await listViews(this.draft.name, maxViews);
    });
    replace(this.progress);
    this.isBusy = false;
    this.updatePanel();
    this.updateCaptures(true);
  }

  private end(action: (draft: StablePose) => Promise<void>, text: string): Promise<void> {
    return this.attempt(async () => {
      const { draft } = this;
      if (!draft || this.isBusy) return;
      await action(draft);
      this.draft = undefined;
      this.files = undefined;
      this.stored = [];
      this.refusals = [];
      replace(this.progress, `${draft.name} ${text}`);
      this.updatePanel();
      this.updateCaptures(false);
    });
  }

  private updatePanel(): void {
    const { draft } = this;
    if (!draft) {
      return replace(this.panel, h("h2", {}, "Draft"), h("p", { className: "hint" },
        "The picture has the points in the region and above the table. With poses of the object all captures are put together: they should form one object. ",
        "Store them as a draft, and look at the views as the server has segmented them. Only cells with drafts recognise a draft. Then release or delete it."));
    }
    replace(this.panel, h("h2", {}, "Draft"), h("p", {}, h("code", {}, draft.name)),
      h("p", {}, `${this.stored.length} view${this.stored.length === 1 ? "" : "s"} stored; the picture has them as the server does.`),
      this.refusals.length > 0 && h("div", { className: "advice", role: "alert" }, h("p", {}, h("strong", {}, `${this.refusals.length} refused:`)),
        this.refusals.map(([name, error]) => h("p", {}, `${name}: ${error.title}, ${error.text}`, error.advice !== "" && h("span", {}, " ", h("strong", {}, "Next step: "), error.advice)))),
      h("button", { type: "button", className: "primary", disabled: this.stored.length === 0, onclick: () => void this.end(releaseDraft, "is released: cells recognise it.") }, "Release"),
      h("p", {}, h("button", { type: "button", onclick: () => void this.end((draft) => deleteDrafts([draft]), "is deleted.") }, "Delete the draft")),
      this.stored.map((each) => h("p", { className: "hint" }, `${lastPart(each.name)}: ${count(each.pointCount)} points${each.objectPoseEstimated ? ", pose estimated" : ""}`)));
  }

  private async draw(look: boolean): Promise<void> {
    const drawing = ++this.drawing;
    const { files, draft } = this;
    const isStored = draft !== undefined && this.stored.length > 0;
    const shown: Points[] = isStored
      ? await Promise.all(viewsToDraw(this.stored).map((each) => pointsInObjectFrame(each.name)))
      : (files?.captures ?? []).map((each, i) => shownPoints({ ...each.scan, segmented: this.segmented.checked }, this.sensorPose(i), this.objectPose(i), this.region()));
    if (drawing !== this.drawing) return;
    const pane = emptyPane();
    const box = boxOf(shown);
    shown.forEach((points, i) => {
      if (!isStored && this.selected >= 0) pane.content.add(cloudObject(points, styleColor(i === this.selected ? "--high" : "--table"), i === this.selected ? 3 : 1));
      else pane.content.add(heightObject(points, box.min.z, box.max.z, 2));
    });
    pane.content.add(axesObject(new Matrix4(), 0.05));
    this.viewer.show([pane]);
    if (look && !box.isEmpty()) this.viewer.look(box.clone().expandByScalar(0.02));
    replace(this.title, shown.length > 0 && h("span", { className: "chip" }, isStored ? "the draft's views, of the server" : "captures, not stored"));
  }
}
