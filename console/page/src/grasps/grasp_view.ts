// The editor of a stable pose's grasps.
import { clone, create, equals } from "@bufbuild/protobuf";
import { Code, ConnectError } from "@connectrpc/connect";
import { Group, Matrix4, Vector3, type Box3 } from "three";
import { GraspSchema, type Grasp, type StablePose, type View } from "../../gen/graspdb/v1/catalog_pb";
import { catalog, explain, listViews, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { h, replace } from "../base/dom";
import { matrixOf, poseOf, type Points } from "../base/geometry";
import { GraspForm } from "./grasp_form";
import { PosePicker } from "../base/pose_picker";
import { boxOf, pointsInObjectFrame, viewsToDraw } from "../catalogue/stable_pose_points";
import { lastPart, millimetres } from "../base/text";
import { axesObject, emptyPane, gripperObject, handleObject, heightObject, linesObject, styleColor, Viewer, type DragMode } from "../base/viewer";

const maxViews = 500;
const graspColor = "#f08a24";

const sameGrasps = (a: Grasp[], b: Grasp[]): boolean => a.length === b.length && a.every((each, i) => equals(GraspSchema, each, b[i]!));

// What differs from `before` in `after`, in words.
export function graspChanges(before: Grasp[], after: Grasp[]): string[] {
  const of = (grasps: Grasp[], id: string): Grasp | undefined => grasps.find((each) => each.graspId === id);
  return [
    ...after.filter((each) => !of(before, each.graspId)).map((each) => `${each.graspId} is new`),
    ...before.filter((each) => !of(after, each.graspId)).map((each) => `${each.graspId} is deleted`),
    ...after.filter((each) => { const old = of(before, each.graspId); return old && !equals(GraspSchema, old, each); }).map((each) => `${each.graspId} is changed`),
  ];
}

export class GraspView {
  readonly element: HTMLElement;
  private readonly picker = new PosePicker((name) => this.load(name), (action) => this.attempt(action));
  private readonly viewer = new Viewer("The grasps", (key) => this.select(Number(key)));
  private readonly form = new GraspForm((grasp) => this.change(grasp));
  private readonly list = h("div", { className: "answers" });
  private readonly panel = h("div", { className: "panel" });
  private readonly saveButton = h("button", { type: "button", className: "primary", onclick: () => void this.save(this.loaded?.etag ?? "") }, "Save the grasps");
  private readonly discardButton = h("button", { type: "button", onclick: () => this.discard() }, "Discard the changes");
  private readonly state = h("p", { className: "hint", role: "status" });
  private readonly conflict = h("div", { className: "advice conflict", role: "alert", hidden: true });
  private readonly modes: HTMLButtonElement[];
  private mode: DragMode = "translate";
  private space: "local" | "world" = "local";
  private wanted = "";
  private loaded: StablePose | undefined;
  private grasps: Grasp[] = [];
  private selected = 0;
  private clouds: Points[] = [];
  private step = 0;

  constructor(private readonly report: (error: Explained | undefined) => void) {
    const button = (text: string, press: () => void): HTMLButtonElement => h("button", {
      type: "button", onclick: () => {
        press();
        this.draw(false);
      },
    }, text);
    this.modes = [
      button("Move", () => (this.mode = "translate")), button("Turn", () => (this.mode = "rotate")),
      button("Tool's axes", () => (this.space = "local")), button("Object's axes", () => (this.space = "world")),
    ];
    this.element = h("div", { className: "scene grasps" },
      h("aside", { "aria-label": "Stable pose and grasps" }, this.picker.element, this.list, this.saveButton, this.discardButton, this.state, this.conflict),
      h("div", { className: "stage" }, h("div", { className: "poses", role: "group", "aria-label": "How to drag" }, this.modes), this.viewer.element),
      h("aside", { className: "right", "aria-label": "Grasp" }, this.panel));
  }

  // Of the next opening.
  choose(stablePose: string): void {
    this.wanted = stablePose;
  }

  opened(): void {
    this.viewer.draw();
    if (this.isChanged()) return;
    const { wanted } = this;
    this.wanted = "";
    void this.attempt(() => this.picker.open(wanted));
  }

  recolour(): void {
    this.draw(false);
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action);
  }

  private isChanged(): boolean {
    return this.loaded !== undefined && !sameGrasps(this.loaded.grasps, this.grasps);
  }

  private async load(name: string): Promise<void> {
    const step = ++this.step;
    this.conflict.hidden = true;
    const [pose, views] = name === "" ? [undefined, [] as View[]] : await Promise.all([catalog.getStablePose({ name }), listViews(name, maxViews)]);
    const clouds = await Promise.all(viewsToDraw(views).map((each) => pointsInObjectFrame(each.name)));
    if (step !== this.step) return;
    this.clouds = clouds;
    this.take(pose, true);
  }

  private take(pose: StablePose | undefined, look: boolean): void {
    this.loaded = pose;
    this.grasps = (pose?.grasps ?? []).map((each) => clone(GraspSchema, each));
    this.selected = Math.min(this.selected, Math.max(0, this.grasps.length - 1));
    this.update(look);
  }

  private update(look: boolean): void {
    this.updateList();
    this.updatePanel();
    this.draw(look);
  }

  private select(index: number): void {
    this.selected = index;
    this.update(false);
  }

  // By the form.
  private change(grasp: Grasp): void {
    this.grasps[this.selected] = grasp;
    this.updateList();
    this.draw(false);
  }

  private updateList(): void {
    const isChanged = this.isChanged();
    replace(this.list, h("h2", {}, "Grasps"), this.grasps.map((each, i) => {
      const counts = this.loaded?.graspOutcomes.find((one) => one.graspId === each.graspId);
      return h("div", { className: "row" },
        h("button", { type: "button", className: "pick", "aria-pressed": i === this.selected, onclick: () => this.select(i) }, each.graspId || "(no id)",
          h("small", {}, `opens ${millimetres(each.gripperOpeningM)}, priority ${each.priority}`),
          h("small", {}, counts ? `${counts.pickedCount} picked, ${counts.missedCount} missed, ${counts.slippedCount} slipped` : "no outcome yet")));
    }), this.grasps.length === 0 && h("p", { className: "hint" }, this.loaded ? "None is taught." : "There is no stable pose."),
    h("div", { className: "row" },
      h("button", { type: "button", disabled: !this.loaded, onclick: () => this.add(this.newGrasp()) }, "Add"),
      h("button", { type: "button", disabled: this.grasps.length === 0, onclick: () => this.add(this.grasps[this.selected]!) }, "Copy"),
      h("button", { type: "button", disabled: this.grasps.length === 0, onclick: () => this.remove() }, "Delete")));
    this.saveButton.disabled = this.discardButton.disabled = !isChanged;
    this.picker.setDisabled(isChanged);
    replace(this.state, isChanged ? `Not saved: ${graspChanges(this.loaded?.grasps ?? [], this.grasps).join(", ") || "another order"}.${this.lostCounts()}` : "");
  }

  // A change of the tool pose, the opening or the free turn begins the counts anew.
  private lostCounts(): string {
    const lost = (this.loaded?.graspOutcomes ?? []).filter((counts) => {
      const [before, after] = [this.loaded!.grasps, this.grasps].map((all) => all.find((each) => each.graspId === counts.graspId));
      if (!before || !after) return true;
      const plain = (grasp: Grasp): Grasp => ({ ...clone(GraspSchema, grasp), priority: 0, approachDistanceM: 0, retreatDistanceM: 0 });
      return !equals(GraspSchema, plain(before), plain(after));
    });
    return lost.length === 0 ? "" : ` The outcome counts of ${lost.map((each) => each.graspId).join(", ")} begin at zero then.`;
  }

  private updatePanel(): void {
    const grasp = this.grasps[this.selected];
    if (!grasp) return replace(this.panel, h("p", { className: "hint" }, "Add a grasp: it begins above the object, and points down."));
    this.form.show(grasp);
    if (!this.form.element.isConnected) {
      replace(this.panel, h("h2", {}, "Grasp"), this.form.element,
        h("p", { className: "hint" }, "The tool's z axis is the direction of approach, x the direction in which it closes. Drag the arrows or rings in the picture, or type."));
    }
  }

  private box(): Box3 {
    return boxOf(this.clouds);
  }

  // Above the middle of the object, the tool downwards.
  private newGrasp(): Grasp {
    const box = this.box();
    const top = box.isEmpty() ? new Vector3(0, 0, 0.05) : box.getCenter(new Vector3()).setZ(box.max.z);
    return create(GraspSchema, {
      graspId: "grasp", tcpPose: poseOf(new Matrix4().makeRotationX(Math.PI).setPosition(top)), gripperOpeningM: 0.05, approachDistanceM: 0.1, retreatDistanceM: 0.1,
    });
  }

  private add(like: Grasp): void {
    const grasp = clone(GraspSchema, like);
    const base = grasp.graspId.replace(/-\d+$/, "").slice(0, 56);
    for (let i = 2; this.grasps.some((each) => each.graspId === grasp.graspId); ++i) grasp.graspId = `${base}-${i}`;
    this.grasps.push(grasp);
    this.select(this.grasps.length - 1);
  }

  private remove(): void {
    this.grasps.splice(this.selected, 1);
    this.select(Math.max(0, this.selected - 1));
  }

  private discard(): void {
    this.conflict.hidden = true;
    this.take(this.loaded, false);
  }

  private async save(etag: string): Promise<void> {
    const { loaded } = this;
    if (!loaded) return;
    this.report(undefined);
    this.conflict.hidden = true;
    this.saveButton.disabled = true;
    try {
      await catalog.updateStablePose({ stablePose: { name: loaded.name, etag, grasps: this.grasps }, updateMask: { paths: ["grasps"] } });
      this.take(await catalog.getStablePose({ name: loaded.name }), false);  // with the outcomes
      replace(this.state, `Saved, revision ${(await catalog.getCatalogStatus({})).catalogRevision}.`);
    } catch (error) {
      if (ConnectError.from(error).code === Code.Aborted) await this.attempt(async () => this.showConflict(await catalog.getStablePose({ name: loaded.name })));
      else this.report(explain(error));
      this.saveButton.disabled = !this.isChanged();
    }
  }

  // `theirs`: what another one has saved since `loaded`.
  private showConflict(theirs: StablePose): void {
    const changes = graspChanges(this.loaded?.grasps ?? [], theirs.grasps);
    replace(this.conflict,
      h("p", {}, h("strong", {}, "Not saved: "), `${lastPart(theirs.name)} was changed since you loaded it (ABORTED). `,
        changes.length === 0 ? "Its grasps are the same as then." : `In its grasps: ${changes.join(", ")}.`),
      h("p", {}, h("strong", {}, "Next step: "), changes.length === 0 ? "Save again." : "Take theirs and repeat your changes, or replace theirs by yours."),
      h("div", { className: "row" },
        h("button", { type: "button", onclick: () => {
          this.conflict.hidden = true;
          this.take(theirs, false);
        } }, "Take theirs"),
        h("button", { type: "button", onclick: () => void this.save(theirs.etag) }, changes.length === 0 ? "Save again" : "Replace theirs")));
    this.conflict.hidden = false;
  }

  private draw(look: boolean): void {
    const pane = emptyPane();
    const box = this.box();
    for (const points of this.clouds) pane.content.add(heightObject(points, box.min.z, box.max.z, 2));
    pane.content.add(axesObject(new Matrix4(), 0.03));
    let handle: Group | undefined;
    this.grasps.forEach((grasp, i) => {
      const tcp = matrixOf(grasp.tcpPose);
      const isSelected = i === this.selected;
      const group = new Group();
      tcp.decompose(group.position, group.quaternion, group.scale);
      group.add(gripperObject(new Matrix4(), grasp.gripperOpeningM, grasp.approachDistanceM, isSelected ? styleColor("--accent") : graspColor));
      pane.content.add(group);
      if (!isSelected) {
        pane.content.add(handleObject(group.position.clone(), String(i), graspColor));
        return;
      }
      handle = group;
      const up = group.position.clone().setZ(group.position.z + grasp.retreatDistanceM);
      pane.content.add(linesObject([...group.position.toArray(), ...up.toArray()], styleColor("--high")));
      for (const turn of grasp.freeTurn ? [grasp.freeTurn.minDeg, grasp.freeTurn.maxDeg] : []) {
        pane.content.add(gripperObject(new Matrix4().makeRotationZ((turn * Math.PI) / 180).multiply(tcp), grasp.gripperOpeningM, 0, styleColor("--soft")));
      }
    });
    this.viewer.show([pane]);
    if (handle) this.viewer.handle(handle, this.mode, this.space, (ended) => this.dragged(handle!, ended));
    this.modes.forEach((button, i) => button.setAttribute("aria-pressed", String([this.mode === "translate", this.mode === "rotate", this.space === "local", this.space === "world"][i])));
    if (look && !box.isEmpty()) this.viewer.look(box.clone().expandByScalar(0.04));
  }

  private dragged(handle: Group, ended: boolean): void {
    const grasp = clone(GraspSchema, this.grasps[this.selected]!);
    handle.updateMatrix();
    const pose = poseOf(handle.matrix);
    if (!handle.matrix.equals(matrixOf(grasp.tcpPose))) grasp.tcpPose = pose;
    this.grasps[this.selected] = grasp;
    this.form.show(grasp);
    if (!ended) return;
    this.updateList();
    this.draw(false);
  }
}
