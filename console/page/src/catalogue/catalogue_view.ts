// The view of the catalogue: objects with the deleted ones, their stable poses in 3D, and their views.
import { Matrix4, Vector3 } from "three";
import { ReleaseState, type Object$ as CatalogObject, type StablePose, type View } from "../../gen/graspdb/v1/catalog_pb";
import { fullView, listDeletedObjects, listObjects, listStablePoses, listViews, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { deletePose, deleteView, releasePose, type Edit } from "./catalogue_edits";
import { facts, h, replace, table } from "../base/dom";
import { matrixOf } from "../base/geometry";
import { DescriptorPlots } from "./descriptor_plots";
import { ObjectPanel } from "./object_panel";
import { cloudScan, type Scan } from "../files/scan";
import { boxOf, maxDrawnViews, pointsInObjectFrame, viewsToDraw } from "./stable_pose_points";
import { lastPart, millimetres, shortName, utc } from "../base/text";
import { axesObject, cloudObject, emptyPane, gripperObject, handleObject, heightObject, linesObject, styleColor, Viewer } from "../base/viewer";

const maxObjects = 2000;
const maxListedViews = 500;

export class CatalogueView {
  readonly element: HTMLElement;
  private readonly objectList = h("div", { className: "objects" });
  private readonly poseTabs = h("div", { className: "poses" });
  private readonly panel = h("div", { className: "panel" });
  private readonly done = h("p", { role: "status" });
  private readonly ofPose = h("button", { type: "button", onclick: () => void this.attempt(() => this.turnTo(false)) }, "Stable pose");
  private readonly ofObject = h("button", { type: "button", onclick: () => void this.attempt(() => this.turnTo(true)) }, "Object");
  private readonly objectPanel = new ObjectPanel((edit) => this.run(edit), (action) => this.attempt(action));
  private readonly filter = h("input", { type: "search", placeholder: "Find an object", oninput: () => this.updateObjects() });
  private readonly viewer = new Viewer("The stable pose", (key) => void this.selectView(this.views[Number(key)]));
  private objects: CatalogObject[] = [];
  private deleted: CatalogObject[] = [];
  private object: CatalogObject | undefined;
  private poses: StablePose[] = [];
  private pose: StablePose | undefined;
  private views: View[] = [];
  private view: View | undefined;
  private plots = new DescriptorPlots();  // of `view`
  private isObjectShown = false;
  private isBusy = false;
  private step = 0;

  constructor(
    private readonly report: (error: Explained | undefined) => void, private readonly use: (scan: Scan) => void,
    private readonly editGrasps: (stablePose: string) => void, private readonly changed: () => void,
  ) {
    this.filter.setAttribute("aria-label", "Find an object");
    this.element = h("div", { className: "scene catalogue" },
      h("aside", { "aria-label": "Objects" }, this.filter, this.objectList),
      h("div", { className: "stage" }, this.poseTabs, this.viewer.element),
      h("aside", { className: "right", "aria-label": "Object and stable pose" },
        h("div", { className: "tabs", role: "group", "aria-label": "What to show" }, this.ofPose, this.ofObject), this.done, this.panel));
  }

  opened(): void {
    void this.attempt(async () => {
      const isFirst = this.object === undefined;
      await this.readObjects();
      if (isFirst && this.objects[0]) await this.selectObject(this.objects[0]);
      else if (this.objects.length === 0 && !this.object) this.showEmpty();
    });
    this.viewer.draw();
  }

  private async readObjects(): Promise<void> {
    [this.objects, this.deleted] = await Promise.all([listObjects(maxObjects), listDeletedObjects(maxObjects)]);
    this.updateObjects();
  }

  private showEmpty(): void {
    replace(this.panel, h("p", { className: "hint" }, "The catalogue is empty. The view Teach, graspdb teach and graspdb import fill it."));
  }

  // Carries an edit out. What is shown is read again afterwards, also where the server refused it: another one may have been first.
  private async run(edit: Edit): Promise<void> {
    if (this.isBusy) return;
    this.isBusy = true;
    await this.attempt(async () => {
      this.report(undefined);
      replace(this.done);
      let text: string | undefined;
      try {
        text = await edit();
        if (text === undefined) return;
      } catch (error) {
        await this.reread();
        throw error;
      }
      await this.reread();
      replace(this.done, text);
    });
    this.isBusy = false;
  }

  private async reread(): Promise<void> {
    this.changed();
    const [object, pose] = [this.object?.name, this.pose?.name];
    await this.readObjects();
    const again = [...this.objects, ...this.deleted].find((each) => each.name === object) ?? this.objects[0];
    if (again) return this.selectObject(again, pose);
    this.object = undefined;
    this.clear();
    this.updateObjects();
    this.showEmpty();
  }

  recolour(): void {
    this.plots.draw();
    if (this.pose) void this.attempt(() => this.draw(false));
    else this.viewer.draw();
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action);
  }

  private updateObjects(): void {
    const words = this.filter.value.toLowerCase();
    const found = (objects: CatalogObject[]): CatalogObject[] =>
      objects.filter((each) => `${each.name} ${each.displayName} ${each.labels.join(" ")}`.toLowerCase().includes(words));
    const button = (each: CatalogObject): HTMLElement => h("button", {
      type: "button", "aria-pressed": each.name === this.object?.name && !each.deleteTime === !this.object.deleteTime,
      onclick: () => {
        replace(this.done);
        this.report(undefined);
        void this.attempt(() => this.selectObject(each));
      },
    }, h("strong", {}, each.displayName || lastPart(each.name)), h("small", {}, lastPart(each.name),
      each.release === ReleaseState.DRAFT && h("span", { className: "chip" }, "draft"),
      each.deleteTime && h("span", { className: "chip" }, `deleted ${utc(each.deleteTime)}`),
      each.labels.map((label) => h("span", { className: "chip" }, label))));
    const [live, deleted] = [found(this.objects), found(this.deleted)];
    replace(this.objectList, live.map(button), live.length === 0 && h("p", { className: "hint" }, "None."),
      deleted.length > 0 && [h("h2", {}, "Deleted"), deleted.map(button)]);
  }

  // `pose`: the name of the stable pose to show; without it, or where there is none of that name, the first.
  private async selectObject(object: CatalogObject, pose = ""): Promise<void> {
    const step = ++this.step;
    const poses = object.deleteTime ? [] : await listStablePoses(object.name, 100);
    if (step !== this.step) return;
    this.object = object;
    this.poses = poses;
    this.updateObjects();
    const first = poses.find((each) => each.name === pose) ?? poses[0];
    if (first) return this.selectPose(first);
    this.clear();
    await this.turnTo(true);
  }

  private clear(): void {
    this.pose = undefined;
    this.poses = [];
    this.views = [];
    this.view = undefined;
    this.viewer.show([emptyPane()]);
    replace(this.poseTabs);
  }

  // To what the panel shows: the object as a whole, or its stable pose.
  private async turnTo(isObject: boolean): Promise<void> {
    if (this.pose) this.isObjectShown = isObject;  // without one there is only the object
    await this.updatePanel();
  }

  private async selectPose(pose: StablePose): Promise<void> {
    const step = ++this.step;
    const views = await listViews(pose.name, maxListedViews);
    if (step !== this.step) return;
    this.pose = pose;
    this.views = views;
    this.view = undefined;
    replace(this.poseTabs, this.poses.map((each) => h("button", {
      type: "button", "aria-pressed": each === pose, onclick: () => void this.attempt(() => this.selectPose(each)),
    }, each.displayName || lastPart(each.name))));
    await this.draw(true);
  }

  private async selectView(view: View | undefined): Promise<void> {
    this.view = view === this.view ? undefined : view;
    const plots = new DescriptorPlots();
    this.plots = plots;
    await this.attempt(() => this.draw(false));
    if (this.view && this.plots === plots) await this.attempt(() => plots.load(this.view!.name));
  }

  // With the selected one.
  private drawn(): View[] {
    const out = viewsToDraw(this.views);
    return this.view && !out.includes(this.view) ? [...out, this.view] : out;
  }

  private async draw(look: boolean): Promise<void> {
    const step = ++this.step;
    const panel = this.updatePanel();
    const pane = emptyPane();
    const drawn = this.drawn();
    const clouds = await Promise.all(drawn.map((each) => pointsInObjectFrame(each.name)));
    await panel;
    if (step !== this.step) return;
    const box = boxOf(clouds);
    const isOther = (i: number): boolean => this.view !== undefined && drawn[i] !== this.view;
    clouds.forEach((points, i) => {
      if (isOther(i)) pane.content.add(cloudObject(points, styleColor("--table"), 1));
      else if (this.view) pane.content.add(cloudObject(points, styleColor("--high"), 3));
      else pane.content.add(heightObject(points, box.min.z, box.max.z, 2));
    });
    for (const grasp of this.pose?.grasps ?? []) {
      pane.content.add(gripperObject(matrixOf(grasp.tcpPose), grasp.gripperOpeningM, grasp.approachDistanceM, "#f08a24"));
    }
    // The directions of the cameras.
    const center = box.getCenter(new Vector3());
    const radius = 0.75 * Math.max(0.05, box.getSize(new Vector3()).length());
    drawn.forEach((each, i) => {
      const sensor = new Vector3().setFromMatrixPosition(matrixOf(each.objectPose).invert().multiply(matrixOf(each.sensorPose)));
      const direction = sensor.sub(center).normalize();
      const [from, to] = [center.clone().addScaledVector(direction, radius), center.clone().addScaledVector(direction, 1.15 * radius)];
      pane.content.add(linesObject([...from.toArray(), ...to.toArray()], isOther(i) ? styleColor("--table") : styleColor("--high")));
      pane.content.add(handleObject(to, String(this.views.indexOf(each)), isOther(i) ? styleColor("--table") : styleColor("--high")));
    });
    pane.content.add(axesObject(new Matrix4(), 0.03));
    this.viewer.show([pane]);
    if (look) this.viewer.look(box.clone().expandByScalar(0.25 * radius));
  }

  private async updatePanel(): Promise<void> {
    const { pose, object } = this;
    if (!object) return;
    const isObject = !pose || this.isObjectShown;
    this.ofPose.disabled = !pose;
    this.ofPose.setAttribute("aria-pressed", String(!isObject));
    this.ofObject.setAttribute("aria-pressed", String(isObject));
    if (pose && !isObject) return this.showPose(object, pose);
    replace(this.panel, this.objectPanel.element);
    await this.objectPanel.show(object);
  }

  private showPose(object: CatalogObject, pose: StablePose): void {
    const rows = pose.grasps.map((grasp) => {
      const outcome = pose.graspOutcomes.find((each) => each.graspId === grasp.graspId);
      return [grasp.graspId, millimetres(grasp.gripperOpeningM), millimetres(grasp.approachDistanceM), grasp.priority,
        outcome ? `${outcome.pickedCount} / ${outcome.missedCount} / ${outcome.slippedCount}` : "–"];
    });
    const symmetry = pose.symmetryOrder ?? 1;
    const isDraft = pose.release === ReleaseState.DRAFT;
    replace(this.panel,
      h("h2", {}, object.displayName || lastPart(object.name)),
      facts([
        ["stable pose", shortName(pose.name)], ["state", isDraft ? "draft" : object.release === ReleaseState.DRAFT ? "draft, as its object" : "released"],
        ["symmetry", symmetry === 0 ? "any turn" : symmetry === 1 ? "none" : `${symmetry}-fold`],
        ["minimum score", pose.minScore === undefined ? "the cell's" : String(pose.minScore)],
        ["views", this.views.length >= maxListedViews ? `${maxListedViews} or more` : String(this.views.length)],
        ["changed (UTC)", utc(pose.updateTime)],
      ]),
      h("div", { className: "choices" },
        h("button", { type: "button", onclick: () => void this.run(() => releasePose(pose, isDraft ? ReleaseState.RELEASED : ReleaseState.DRAFT)) },
          isDraft ? "Release the stable pose …" : "Make it a draft …"),
        h("button", { type: "button", className: "danger", onclick: () => void this.run(() => deletePose(pose)) }, "Delete the stable pose …")),
      h("h3", {}, "Grasps"),
      h("p", {}, h("a", { href: "#grasps", onclick: () => this.editGrasps(pose.name) }, "Edit the grasps")),
      rows.length > 0 ? table(["grasp", "opening", "approach", "priority", "picked / missed / slipped"], rows) : h("p", { className: "hint" }, "None is taught."),
      h("h3", {}, "Views"),
      this.views.length > maxDrawnViews && h("p", { className: "hint" }, `${maxDrawnViews} of them are drawn.`),
      h("div", { className: "views" }, this.views.map((each) => {
        const row = h("div", { className: "row" },
          h("button", { type: "button", className: "pick", "aria-pressed": each === this.view, onclick: () => void this.selectView(each) },
            lastPart(each.name), h("small", {}, `${each.pointCount.toLocaleString("en")} points${each.objectPoseEstimated ? ", pose estimated" : ""}`)),
          h("button", { type: "button", className: "beside", title: "Open it as a scan", onclick: () => void this.openScan(each) }, "open"),
          each === this.view && h("button", { type: "button", className: "beside danger", title: "Delete this view", onclick: () => void this.run(() => deleteView(each)) }, "delete …"));
        return each === this.view ? [row, this.plots.element] : row;
      })));
  }

  private openScan(view: View): Promise<void> {
    return this.attempt(async () => {
      const full = await fullView(view.name);
      if (full.cloud) this.use(cloudScan(shortName(view.name), full.cloud, full.sensorPose, true));
    });
  }
}
