// The view of the catalogue: objects, their stable poses in 3D, and their views.
import { Matrix4, Vector3 } from "three";
import { ReleaseState, type Object$ as CatalogObject, type StablePose, type View } from "../gen/graspdb/v1/catalog_pb";
import { explain, fullView, listObjects, listStablePoses, listViews, type Explained } from "./api";
import { facts, h, replace, table } from "./dom";
import { matrixOf } from "./geometry";
import { cloudScan, type Scan } from "./scan";
import { boxOf, maxDrawnViews, pointsInObjectFrame, viewsToDraw } from "./stable_pose_points";
import { lastPart, millimetres, shortName } from "./text";
import { axesObject, cloudObject, emptyPane, gripperObject, handleObject, heightObject, linesObject, styleColor, Viewer } from "./viewer";

const maxObjects = 2000;
const maxListedViews = 500;

export class CatalogueView {
  readonly element: HTMLElement;
  private readonly objectList = h("div", { className: "objects" });
  private readonly poseTabs = h("div", { className: "poses" });
  private readonly panel = h("div", { className: "panel" });
  private readonly filter = h("input", { type: "search", placeholder: "Find an object", oninput: () => this.updateObjects() });
  private readonly viewer = new Viewer("The stable pose", (key) => void this.selectView(this.views[Number(key)]));
  private objects: CatalogObject[] = [];
  private object: CatalogObject | undefined;
  private poses: StablePose[] = [];
  private pose: StablePose | undefined;
  private views: View[] = [];
  private view: View | undefined;
  private step = 0;

  constructor(
    private readonly report: (error: Explained | undefined) => void, private readonly use: (scan: Scan) => void,
    private readonly editGrasps: (stablePose: string) => void,
  ) {
    this.filter.setAttribute("aria-label", "Find an object");
    this.element = h("div", { className: "scene catalogue" },
      h("aside", { "aria-label": "Objects" }, this.filter, this.objectList),
      h("div", { className: "stage" }, this.poseTabs, this.viewer.element),
      h("aside", { className: "right", "aria-label": "Stable pose" }, this.panel));
  }

  opened(): void {
    void this.attempt(async () => {
      this.objects = await listObjects(maxObjects);
      this.updateObjects();
      const first = this.objects.find((each) => each.name === this.object?.name) ?? this.objects[0];
      if (first && !this.object) await this.selectObject(first);
      if (!first) replace(this.panel, h("p", { className: "hint" }, "The catalogue is empty. The view Teach, graspdb teach and graspdb import fill it."));
    });
    this.viewer.draw();
  }

  recolour(): void {
    if (this.pose) void this.attempt(() => this.draw(false));
  }

  private async attempt(action: () => Promise<void>): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.report(explain(error));
    }
  }

  private updateObjects(): void {
    const words = this.filter.value.toLowerCase();
    const found = this.objects.filter((each) => `${each.name} ${each.displayName} ${each.labels.join(" ")}`.toLowerCase().includes(words));
    replace(this.objectList, found.map((each) => h("button", {
      type: "button", "aria-pressed": each.name === this.object?.name, onclick: () => void this.attempt(() => this.selectObject(each)),
    }, h("strong", {}, each.displayName || lastPart(each.name)), h("small", {}, lastPart(each.name),
      each.release === ReleaseState.DRAFT && h("span", { className: "chip" }, "draft"),
      each.labels.map((label) => h("span", { className: "chip" }, label))))),
    found.length === 0 && h("p", { className: "hint" }, "None."));
  }

  private async selectObject(object: CatalogObject): Promise<void> {
    this.report(undefined);
    const step = ++this.step;
    const poses = await listStablePoses(object.name, 100);
    if (step !== this.step) return;
    this.object = object;
    this.poses = poses;
    this.updateObjects();
    if (poses[0]) return this.selectPose(poses[0]);
    this.pose = undefined;
    this.views = [];
    this.viewer.show([emptyPane()]);
    replace(this.poseTabs);
    replace(this.panel, h("p", { className: "hint" }, "It has no stable pose."));
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
    await this.attempt(() => this.draw(false));
  }

  // With the selected one.
  private drawn(): View[] {
    const out = viewsToDraw(this.views);
    return this.view && !out.includes(this.view) ? [...out, this.view] : out;
  }

  private async draw(look: boolean): Promise<void> {
    const step = ++this.step;
    this.updatePanel();
    const pane = emptyPane();
    const drawn = this.drawn();
    const clouds = await Promise.all(drawn.map((each) => pointsInObjectFrame(each.name)));
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

  private updatePanel(): void {
    const { pose, object } = this;
    if (!pose || !object) return;
    const rows = pose.grasps.map((grasp) => {
      const outcome = pose.graspOutcomes.find((each) => each.graspId === grasp.graspId);
      return [grasp.graspId, millimetres(grasp.gripperOpeningM), millimetres(grasp.approachDistanceM), grasp.priority,
        outcome ? `${outcome.pickedCount} / ${outcome.missedCount} / ${outcome.slippedCount}` : "–"];
    });
    const time = (stamp: { seconds: bigint } | undefined): string => stamp ? new Date(Number(stamp.seconds) * 1000).toISOString().slice(0, 16).replace("T", " ") : "–";
    const symmetry = pose.symmetryOrder ?? 1;
    replace(this.panel,
      h("h2", {}, object.displayName || lastPart(object.name)),
      facts([
        ["stable pose", shortName(pose.name)], ["state", [object.release, pose.release].includes(ReleaseState.DRAFT) ? "draft" : "released"],
        ["symmetry", symmetry === 0 ? "any turn" : symmetry === 1 ? "none" : `${symmetry}-fold`],
        ["minimum score", pose.minScore === undefined ? "the cell's" : String(pose.minScore)],
        ["views", this.views.length >= maxListedViews ? `${maxListedViews} or more` : String(this.views.length)],
        ["changed (UTC)", time(pose.updateTime)],
      ]),
      h("h3", {}, "Grasps"),
      h("p", {}, h("a", { href: "#grasps", onclick: () => this.editGrasps(pose.name) }, "Edit the grasps")),
      rows.length > 0 ? table(["grasp", "opening", "approach", "priority", "picked / missed / slipped"], rows) : h("p", { className: "hint" }, "None is taught."),
      h("h3", {}, "Views"),
      this.views.length > maxDrawnViews && h("p", { className: "hint" }, `${maxDrawnViews} of them are drawn.`),
      h("div", { className: "views" }, this.views.map((each) => {
        return h("div", { className: "row" },
          h("button", { type: "button", className: "pick", "aria-pressed": each === this.view, onclick: () => void this.selectView(each) },
            lastPart(each.name), h("small", {}, `${each.pointCount.toLocaleString("en")} points${each.objectPoseEstimated ? ", pose estimated" : ""}`)),
          h("button", { type: "button", className: "beside", title: "Open it as a scan", onclick: () => void this.openScan(each) }, "open"));
      })));
  }

  private openScan(view: View): Promise<void> {
    return this.attempt(async () => {
      const full = await fullView(view.name);
      if (full.cloud) this.use(cloudScan(shortName(view.name), full.cloud, full.sensorPose, true));
    });
  }
}
