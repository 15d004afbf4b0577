// Teaching from a mesh: its stable poses are shown, views of the chosen ones rendered and shown, and stored as drafts.
import { Matrix4, Vector3, type Box3 } from "three";
import type { StablePose } from "../../gen/graspdb/v1/catalog_pb";
import type { Cell } from "../../gen/graspdb/v1/cell_pb";
import { listCells, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { showCells } from "../base/cell_options";
import { bar, facts, h, replace } from "../base/dom";
import { deleteDrafts, releaseDraft } from "../teach/teach_draft";
import { count } from "../base/text";
import { emptyPane, Viewer } from "../base/viewer";
import { fittingUnits, largestSideOf, lengthUnits, type MeshFile } from "./mesh_file";
import { drawMesh, drawPoses, drawViews, percent, type Choice } from "./mesh_scene";
import { revived, runMeshTask, type FoundPoses } from "./mesh_task";
import { storeMesh } from "./mesh_upload";
import { standardStand, standOf, standOfCell, type MeshView } from "./mesh_views";
import type { MeshStablePose } from "./stable_poses";
import { boundsOf, scaled, type TriangleMesh } from "./triangle_mesh";
import { viewThumbnail } from "./view_thumbnail";

const symmetryText = (pose: MeshStablePose): string => {
  const order = pose.symmetry.order === 0 ? "any turn" : pose.symmetry.order === 1 ? "none" : `${pose.symmetry.order}-fold`;
  return `${pose.symmetry.isNearly ? `none (nearly ${order})` : order}${pose.rolls ? ", rolls" : ""}`;
};

// As graspdb makes it of a file's name.
const objectIdOf = (name: string): string =>
  name.replace(/\.[^.]*$/, "").toLowerCase().replace(/[^a-z0-9_.]/g, "-").replace(/^[-_.]+/, "").slice(0, 63) || "mesh";

export class MeshTeachView {
  readonly element: HTMLElement;
  private readonly viewer = new Viewer("The stable poses of the mesh", (key) => this.pick(key));
  private readonly object = h("input", { id: "mesh-object", type: "text", spellcheck: false, autocomplete: "off" });
  private readonly displayName = h("input", { id: "mesh-name", type: "text", spellcheck: false, autocomplete: "off" });
  private readonly unit = h("select", { id: "mesh-unit", onchange: () => void this.computePoses() }, Object.keys(lengthUnits).map((each) => h("option", { value: each }, each)));
  private readonly cell = h("select", { id: "mesh-cell", onchange: () => this.dropViews() });
  private readonly lookDown = this.number("mesh-look-down", standardStand.lookDownDeg);
  private readonly distance = this.number("mesh-distance", 1000 * standardStand.distance);
  private readonly step = this.number("mesh-step", standardStand.stepDeg);
  private readonly size = h("div", {});
  private readonly renderButton = h("button", { type: "submit", className: "primary" }, "Draw the views");
  private readonly storeButton = h("button", { type: "button", className: "primary", onclick: () => void this.store() }, "Store as drafts");
  private readonly cancelButton = h("button", { type: "button", onclick: () => this.stop?.abort() }, "Cancel");
  private readonly progressBar = h("progress", { max: 1 });
  private readonly progressText = h("p", { role: "status" });
  private readonly panel = h("div", { className: "panel" });
  private readonly title = h("div", { className: "poses" });
  private cells: Cell[] = [];
  private name = "";
  private file: MeshFile | undefined;
  private mesh: TriangleMesh | undefined;  // in metres
  private found: FoundPoses | undefined;
  private choices: Choice[] = [];
  private selected = 0;
  private views: MeshView[] = [];
  private worldSensor = new Matrix4();
  private view = -1;
  private drafts: StablePose[] = [];
  private stop: AbortController | undefined;

  constructor(private readonly report: (error: Explained | undefined) => void) {
    const field = (element: HTMLElement, label: string, unit = ""): HTMLElement => h("div", { className: "field" },
      h("label", { for: element.id }, label), element, unit !== "" && h("span", { className: "unit" }, unit));
    this.progressBar.setAttribute("aria-label", "Progress");
    const form = h("form", {
      noValidate: true, onsubmit: (event: Event) => {
        event.preventDefault();
        void this.render();
      },
    },
    this.size, field(this.unit, "unit of the file"), field(this.object, "object id"), field(this.displayName, "its name"),
    h("h2", {}, "Views"), h("p", { className: "hint" }, "The camera stands still, and the object turns about itself. A cell gives the angle and distance of its own camera."),
    field(this.cell, "cell"), field(this.lookDown, "looks down by", "°"), field(this.distance, "from a distance of", "mm"), field(this.step, "a view every", "°"), this.renderButton);
    this.element = h("div", { className: "scene teach mesh" },
      h("aside", { "aria-label": "Mesh" }, form),
      h("div", { className: "stage" }, this.title, this.viewer.element),
      h("aside", { className: "right", "aria-label": "Stable poses" }, this.progressText, this.panel));
  }

  private number(id: string, value: number): HTMLInputElement {
    return h("input", { id, type: "number", step: "any", value: String(value), oninput: () => this.dropViews() });
  }

  opened(): void {
    this.viewer.draw();
    void this.attempt(async () => {
      this.cells = await listCells(1000);
      showCells(this.cell, this.cells);
      this.updateButtons();
    });
  }

  recolour(): void {
    this.draw(false);
  }

  async open(file: File): Promise<void> {
    let read: MeshFile | undefined;
    await this.work(async (signal, report) => {
      report(-1, `Reading ${file.name}`);
      read = await runMeshTask({ kind: "read", file }, signal, report);
    });
    if (!read) return;
    this.file = read;
    this.name = file.name;
    this.object.value = objectIdOf(file.name);
    this.displayName.value = "";
    this.unit.value = read.stated || fittingUnits(largestSideOf(read.mesh))[0] || "mm";
    await this.computePoses();
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action, "This cannot be taught");
  }

  // Runs long work with a progress bar and Cancel, one at a time. `share`: below 0 where it is not known. `done`: to show at the end.
  private async work(action: (signal: AbortSignal, report: (share: number, text: string) => void) => Promise<void>, done = ""): Promise<void> {
    this.stop?.abort();
    const stop = new AbortController();
    this.stop = stop;
    this.report(undefined);
    this.updatePanel();
    let text = "";
    await this.attempt(async () => {
      try {
        await action(stop.signal, (share, step) => {
          if (stop !== this.stop) return;
          if (share < 0) this.progressBar.removeAttribute("value");
          else this.progressBar.value = share;
          replace(this.progressText, step);
        });
        text = done;
      } catch (error) {
        if (!stop.signal.aborted) throw error;
        text = "Cancelled.";
      }
    });
    if (stop !== this.stop) return;
    this.stop = undefined;
    replace(this.progressText, text);
    this.updatePanel();
  }

  private updateSize(): boolean {
    const side = largestSideOf(this.file!.mesh);
    const units = fittingUnits(side);
    const fits = units.includes(this.unit.value);
    const sides = boundsOf(scaled(this.file!.mesh, 1000 * lengthUnits[this.unit.value]!)).getSize(new Vector3()).toArray().map((each) => each.toPrecision(3));
    replace(this.size, facts([["file", this.name], ["triangles", count(this.file!.mesh.triangles.length / 3)], ["size", `${sides.join(" × ")} mm`]]),
      !fits && h("div", { className: "advice", role: "alert" }, h("p", {}, h("strong", {}, "The size looks wrong. "),
        "Parts have 5 mm to 600 mm. ", units.length > 0 ? `Choose the unit ${units.join(" or ")}.` : "No unit gives the mesh such a size.")),
      this.file!.stated !== "" && this.file!.stated !== this.unit.value && h("div", { className: "advice", role: "alert" },
        h("p", {}, h("strong", {}, "The file states another unit: "), `${this.file!.stated}.`)));
    return fits;
  }

  private async computePoses(): Promise<void> {
    if (!this.file) return;
    this.choices = [];
    this.found = undefined;
    this.selected = 0;
    this.drafts = [];
    this.views = [];
    this.view = -1;
    replace(this.progressText);
    const fits = this.updateSize();
    this.mesh = scaled(this.file.mesh, lengthUnits[this.unit.value]!);
    if (!fits) {
      this.stop?.abort();
      this.stop = undefined;
      this.updatePanel();
      return this.draw(true);
    }
    await this.work(async (signal, report) => {
      this.found = await runMeshTask({ kind: "poses", mesh: this.mesh! }, signal, report);
      this.choices = this.found.poses.map((each) => ({ ...each, pose: revived(each.pose), isChosen: true }));
    });
    this.draw(true);
  }

  private chosen(): Choice[] {
    return this.choices.filter((each) => each.isChosen);
  }

  // What is drawn of views is no longer what would be stored.
  private dropViews(): void {
    if (this.stop || this.drafts.length > 0) return;
    const had = this.views.length > 0;
    this.views = [];
    this.view = -1;
    this.updatePanel();
    if (had) this.draw(true);
  }

  private async render(): Promise<void> {
    if (!this.mesh || this.chosen().length === 0 || this.stop) return;
    await this.work(async (signal, report) => {
      const cell = this.cells.find((each) => each.name === this.cell.value);
      const [distance, down] = [this.distance.valueAsNumber / 1000, this.lookDown.valueAsNumber];
      if (!cell && !(distance >= 0.1 && distance <= 5)) throw new Error("distance: 100 to 5000 mm");
      if (!cell && !(down >= 0 && down <= 90)) throw new Error("looks down by: 0 to 90°");
      this.worldSensor = cell ? standOfCell(cell) : standOf(distance, down);
      const poses = this.chosen().map((each) => each.pose);
      this.views = await runMeshTask(
        { kind: "views", mesh: this.mesh!, poses, worldSensor: this.worldSensor, stepDeg: this.step.valueAsNumber, objectId: this.object.value }, signal, report);
      this.view = -1;
      if (!this.chosen().includes(this.choices[this.selected]!)) this.selected = this.choices.findIndex((each) => each.isChosen);
    });
    this.draw(true);
  }

  private async store(): Promise<void> {
    if (this.views.length === 0 || this.stop || this.drafts.length > 0) return;
    const { views } = this;
    await this.work(async (signal, report) => {
      if (this.object.value === "") throw new Error("give the id of the object");
      this.drafts = await storeMesh({
        objectId: this.object.value, displayName: this.displayName.value, mesh: this.mesh!, poses: this.chosen(), views, worldSensor: this.worldSensor,
      }, signal, (done) => report(done / views.length, done === views.length ? "All views are sent: they become part of the catalogue" : `View ${done} of ${views.length} is sent`));
    }, `${views.length} views are stored.`);
  }

  private end(action: (drafts: StablePose[]) => Promise<void>, text: string): Promise<void> {
    return this.attempt(async () => {
      if (this.stop) return;
      await action(this.drafts);
      this.drafts = [];
      this.views = [];
      this.view = -1;
      replace(this.progressText, `${this.object.value} ${text}`);
      this.updatePanel();
      this.draw(true);
    });
  }

  private async release(drafts: StablePose[]): Promise<void> {
    for (const each of drafts) await releaseDraft(each);
  }

  private updateButtons(): void {
    const isBusy = this.stop !== undefined;
    const isStored = this.drafts.length > 0;
    this.renderButton.disabled = isBusy || isStored || this.chosen().length === 0;
    this.storeButton.disabled = isBusy || isStored || this.views.length === 0;
    for (const each of [this.object, this.displayName, this.unit, this.cell, this.step]) each.disabled = isBusy || isStored;
    for (const each of [this.lookDown, this.distance]) each.disabled = isBusy || isStored || this.cell.value !== "";
  }

  private updatePanel(): void {
    this.updateButtons();
    const isStored = this.drafts.length > 0;
    replace(this.panel,
      this.stop && h("div", { className: "progress" }, this.progressBar, this.cancelButton),
      isStored && [h("h2", {}, "Drafts"), h("p", { className: "hint" }, "Only cells with drafts recognise them. Try them there, then release or delete them."),
        this.drafts.map((each) => h("p", {}, h("code", {}, each.name))),
        h("button", { type: "button", className: "primary", onclick: () => void this.end((drafts) => this.release(drafts), "is released: cells recognise it.") }, "Release"),
        h("p", {}, h("button", { type: "button", onclick: () => void this.end(deleteDrafts, "is deleted.") }, "Delete the drafts"))],
      this.views.length > 0 && [h("h2", {}, "Views"), !isStored && [
        h("p", {}, `${this.views.length} views of ${this.chosen().length} stable pose${this.chosen().length === 1 ? "" : "s"} are drawn, and not stored.`), this.storeButton],
      this.thumbnails()],
      this.choices.length > 0 && [h("h2", {}, "Stable poses"), h("p", { className: "hint" }, "How a dropped part comes to rest, the most probable pose first. Untick those that do not occur.")],
      this.choices.map((each, i) => this.row(each, i)),
      this.found && this.found.leftOut > 0.0005 && h("p", { className: "hint" }, `Left out, less probable than 1 % and tipping over within 5°: ${percent(this.found.leftOut)} of the drops.`),
      this.file?.isSided === false && h("p", { className: "hint" }, "Many neighbouring faces turn against each other, so that the outside is not known; turn them alike in the program that made the mesh."),
      this.found?.isOfHull && h("p", { className: "hint" }, "The surface is not closed; the centre of mass is that of its convex hull."));
  }

  private row(choice: Choice, i: number): HTMLElement {
    const { pose } = choice;
    const isFixed = this.stop !== undefined || this.drafts.length > 0;
    const box = h("input", { type: "checkbox", checked: choice.isChosen, disabled: isFixed, onchange: () => {
      choice.isChosen = box.checked;
      this.dropViews();
      this.draw(false);
    } });
    box.setAttribute("aria-label", `Teach ${pose.id}`);
    return h("div", { className: `detection${i === this.selected ? " selected" : ""}` },
      h("div", { className: "row" }, box, h("button", { type: "button", className: "pick", "aria-pressed": i === this.selected, onclick: () => this.select(i) },
        h("strong", {}, pose.id), " ", bar(pose.probability, `${pose.id}: probability`), ` ${percent(pose.probability)}`)),
      h("p", { className: "hint" }, `tips over at ${((pose.tipAngle * 180) / Math.PI).toFixed(1)}° · symmetry: ${symmetryText(pose)} · `,
        choice.grasps.length === 0 ? "no grasp fits from above" : choice.grasps.map((grasp) => `${grasp.graspId} opens ${(1000 * grasp.gripperOpeningM).toFixed(0)} mm`).join(", ")));
  }

  private viewsOfSelected(): MeshView[] {
    return this.views.filter((each) => each.poseId === this.choices[this.selected]?.pose.id);
  }

  private thumbnails(): HTMLElement {
    return h("div", { className: "thumbnails", role: "group", "aria-label": "Views" }, this.viewsOfSelected().map((each, i) => {
      const button = h("button", { type: "button", "aria-pressed": i === this.view, title: `View at ${each.turnDeg}°, ${count(each.points.length / 3)} points`, onclick: () => {
        this.view = i === this.view ? -1 : i;
        this.updatePanel();
        this.draw(false);
      } }, viewThumbnail(each.image, each.seen), h("small", {}, `${each.turnDeg}°`));
      return button;
    }));
  }

  private pick(key: string): void {
    if (key.startsWith("view-")) {
      this.view = Number(key.slice(5));
      this.updatePanel();
      return this.draw(false);
    }
    this.select(Number(key));
  }

  private select(i: number): void {
    this.selected = i;
    this.view = -1;
    this.updatePanel();
    this.draw(this.views.length > 0);
  }

  private draw(look: boolean): void {
    const pane = emptyPane();
    const selected = this.choices[this.selected];
    let box: Box3 | undefined;
    if (selected && this.views.length > 0) box = drawViews(pane, this.viewsOfSelected(), this.view, selected.grasps, this.worldSensor);
    else if (this.choices.length > 0) box = drawPoses(pane, this.choices, this.selected);
    else if (this.mesh) box = drawMesh(pane, this.mesh);
    this.viewer.show([pane]);
    if (look && box && !box.isEmpty()) this.viewer.look(box);
    replace(this.title, this.views.length > 0 && selected && h("span", { className: "chip" }, `${selected.pose.id}: views ${this.drafts.length > 0 ? "as they were sent" : "as they would be sent"}`));
  }
}
