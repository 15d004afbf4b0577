// The view of one scene: a scan, what was recognised in it, and why.
import { Box3, Group, Matrix4, Vector3, type Object3D } from "three";
import { WorldFrameSource } from "../../gen/graspdb/v1/recognition_pb";
import type { RecognizeResponse } from "../../gen/graspdb/v1/recognition_service_pb";
import { cells, listCells, recognition, type Explained, explain } from "../base/api";
import { attempt } from "../base/attempt";
import { objectName, statusName, taughtGrasp, tone, type Answer } from "./answer";
import { answerPanel, comparison } from "./answer_panel";
import { h, replace, takeDrops } from "../base/dom";
import { matrixOf, moved, type Points } from "../base/geometry";
import { givenOf, ParameterForm } from "./parameters";
import { readScan, type Recorded, type Scan } from "../files/scan";
import { pointsInObjectFrame } from "../catalogue/stable_pose_points";
import { lastPart, milliseconds } from "../base/text";
import { axesObject, boxObject, cloudObject, emptyPane, gripperObject, heightObject, styleColor, Viewer, type Pane } from "../base/viewer";

const maxAnswers = 12;
const maxGrasps = 24;
const colors: Record<string, string> = { ok: "#2fbf71", warning: "#e0a526", bad: "#e5534b" };
const layerNames = ["scan", "refined pose", "rough pose", "grasps", "region", "axes"] as const;
type Layer = (typeof layerNames)[number];

// A scan in the world frame, if that is known: then the table is at z = 0.
function scanObject(points: Points, hasTable: boolean): Object3D {
  const tableEnd = 0.006;  // as PipelineParameters.plane_distance_m
  return hasTable ? heightObject(points, tableEnd, 0.15, 1.5) : cloudObject(points, styleColor("--low"), 1.5);
}

export class SceneView {
  readonly element: HTMLElement;
  private readonly form = new ParameterForm();
  private readonly viewer = new Viewer("The scene", (key) => this.selectKey(key));
  private readonly panel = h("div", { className: "panel", "aria-live": "polite" });
  private readonly list = h("div", { className: "answers" });
  private readonly scanLine = h("p", { className: "scan-line" }, "No scan yet.");
  private readonly button = h("button", { type: "submit", className: "primary", disabled: true }, "Recognise");
  private readonly saveButton = h("button", { type: "button", onclick: () => void this.saveParameters() }, "Save them to the cell");
  private readonly saved = h("p", { className: "hint", role: "status" });
  private readonly layers: Set<Layer> = new Set<Layer>(["scan", "refined pose", "grasps", "region"]);
  private scan: Scan | undefined;
  private answers: Answer[] = [];
  private shown: Answer | undefined;
  private beside: Answer | undefined;
  private selected = -1;
  private drawing = 0;

  constructor(private readonly report: (error: Explained | undefined) => void, private readonly done: (answer: Answer) => void) {
    const input = h("input", {
      type: "file", id: "files", multiple: true, accept: ".pcd,.ply,.png,.json,.bundle",
      onchange: () => void this.open([...(input.files ?? [])]),
    });
    const drop = h("label", { className: "drop", for: "files" },
      h("strong", {}, "Drop a file or choose one"), h("span", {}, "PCD, PLY, a 16-bit PNG with intrinsics.json, or a bundle of a black box"), input);
    const layerBoxes = layerNames.map((name) => {
      const box = h("input", {
        type: "checkbox", checked: this.layers.has(name),
        onchange: () => {
          if (box.checked) this.layers.add(name);
          else this.layers.delete(name);
          void this.drawAll(false);
        },
      });
      return h("label", {}, box, " ", name);
    });
    const form = h("form", {
      noValidate: true,  // a browser cannot show what is wrong in a closed part
      onsubmit: (event: Event) => {
        event.preventDefault();
        void this.recognise();
      },
    }, this.form.element, this.button, this.saveButton, this.saved);
    this.element = h("div", { className: "scene" },
      h("aside", { "aria-label": "Scan and parameters" }, drop, this.scanLine, form, this.list),
      h("div", { className: "stage" },
        h("fieldset", { className: "layers" }, h("legend", {}, "Layers"), layerBoxes), this.viewer.element),
      h("aside", { className: "right", "aria-label": "Answer" }, this.panel));
    takeDrops(this.element, (files) => void this.open(files));
    replace(this.panel, h("p", { className: "hint" },
      "Drop a scan, or open a stored view from the catalogue, and recognise it."));
  }

  opened(): void {
    listCells(1000).then((cells) => this.form.setCells(cells), (error) => this.report(explain(error)));
    this.viewer.draw();
  }

  recolour(): void {
    void this.drawAll(false);
  }

  async open(files: File[]): Promise<void> {
    try {
      this.use(await readScan(files, () => this.form.cameraOf()));
    } catch (error) {
      this.report({ title: "This file cannot be read", text: (error as Error).message, advice: "", requestId: "", needsToken: false });
    }
  }

  use(scan: Scan): void {
    this.report(undefined);
    this.scan = scan;
    this.shown = undefined;
    this.beside = undefined;
    this.selected = -1;
    this.form.setSegmented(scan.segmented);
    if (scan.recorded) this.form.setRequest(scan.recorded.request);
    this.button.disabled = false;
    replace(this.scanLine, h("strong", {}, scan.name), ` · ${(scan.points.length / 3).toLocaleString("en")} measured points`,
      scan.sensorPose ? " · has its sensor pose" : "");
    replace(this.panel, h("p", { className: "hint" }, "Not recognised yet."));
    if (scan.recorded?.response) this.addRecorded(scan, scan.recorded, scan.recorded.response);
    this.updateList();
    void this.drawAll(true);
  }

  // The answer that a black box stored with the frame.
  private addRecorded(scan: Scan, { request, durationMs, time }: Recorded, response: RecognizeResponse): void {
    const number = (this.answers.at(-1)?.number ?? 0) + 1;
    this.shown = {
      number, scan, response, elapsedMs: durationMs,
      parameters: {
        cell: request.cell, segmented: request.segmented, region: request.regionOfInterest, searched: request.regionOfInterest,
        pipeline: request.pipeline, summary: `recorded ${time}`,
      },
    };
    this.answers = [...this.answers, this.shown].slice(-maxAnswers);
    this.selected = response.detections.length === 1 ? 0 : -1;
  }

  async recognise(): Promise<void> {
    const { scan } = this;
    if (!scan) return;
    this.report(undefined);
    this.button.disabled = true;
    try {
      const parameters = this.form.read();
      const start = performance.now();
      const response = await recognition.recognize({
        cell: parameters.cell, scan: scan.message, segmented: parameters.segmented,
        regionOfInterest: parameters.region, pipeline: parameters.pipeline,
        sensorPose: scan.recorded ? scan.recorded.request.sensorPose : scan.sensorPose,
      });
      const answer = {
        number: (this.answers.at(-1)?.number ?? 0) + 1, scan, parameters, response, elapsedMs: performance.now() - start,
      };
      this.answers = [...this.answers, answer].slice(-maxAnswers);
      const isFirst = this.shown === undefined;
      this.beside = this.beside && this.answers.includes(this.beside) ? this.beside : undefined;
      this.shown = answer;
      this.selected = response.detections.length === 1 ? 0 : -1;
      this.done(answer);
      const answered = performance.now();
      await this.drawAll(isFirst);
      requestAnimationFrame(() => performance.measure("an answer is drawn", { start: answered }));
    } catch (error) {
      this.report(explain(error, "These parameters cannot be used"));
    } finally {
      this.button.disabled = false;
      this.updateList();
    }
  }

  // The parameters that are given, for all frames of the cell; its others stay.
  private async saveParameters(): Promise<void> {
    this.report(undefined);
    replace(this.saved);
    await attempt(this.report, async () => {
      const { cell: name, pipeline, region } = this.form.read();
      if (name === "") throw new Error("choose the cell");
      if (!pipeline && !region) throw new Error("give a parameter first: the cell has nothing to change");
      const cell = await cells.getCell({ name });
      const paths = [...(pipeline ? ["pipeline"] : []), ...(region ? ["region_of_interest"] : [])];
      await cells.updateCell({
        cell: { name, etag: cell.etag, regionOfInterest: region, pipeline: { ...cell.pipeline, ...givenOf(pipeline) } }, updateMask: { paths },
      });
      this.form.setCells(await listCells(1000));
      replace(this.saved, `Saved: ${lastPart(name)} uses them for all of its frames.`);
    }, "Nothing is saved");
  }

  // `key`: the number of an answer and a detection's index in it. That of the answer beside makes it the shown one.
  private selectKey(key: string): void {
    const [number, index] = key.split(":").map(Number);
    if (this.beside && this.beside.number === number) this.choose(this.beside, this.shown);
    this.select(index!);
  }

  private select(index: number): void {
    this.selected = index;
    this.updatePanel();
    void this.drawAll(false);
  }

  private updateList(): void {
    if (this.answers.length === 0) return replace(this.list);
    replace(this.list, h("h2", {}, "Answers"), [...this.answers].reverse().map((answer) => {
      const pressed = (is: boolean): string => String(is);
      return h("div", { className: "row" },
        h("button", {
          type: "button", className: "pick", "aria-pressed": pressed(answer === this.shown),
          onclick: () => this.choose(answer, this.beside === answer ? undefined : this.beside),
        }, h("strong", {}, `${answer.number} `), `${statusName(answer.response.status)} · ${answer.parameters.summary}`,
        h("small", {}, `${answer.scan.name} · ${milliseconds(answer.response.timings?.totalMs ?? 0)}`)),
        h("button", {
          type: "button", className: "beside", "aria-pressed": pressed(answer === this.beside), disabled: answer === this.shown,
          title: "Show it beside the other one", onclick: () => this.choose(this.shown, answer === this.beside ? undefined : answer),
        }, "beside"));
    }));
  }

  private choose(shown: Answer | undefined, beside: Answer | undefined): void {
    if (shown !== this.shown) this.selected = -1;
    this.shown = shown;
    this.beside = beside;
    if (shown) this.scan = shown.scan;
    this.updateList();
    void this.drawAll(false);
  }

  private updatePanel(): void {
    if (!this.shown) return;
    replace(this.panel, this.beside && comparison(this.shown, this.beside),
      answerPanel(this.shown, this.selected, (index) => this.select(index)));
  }

  private async drawAll(look: boolean): Promise<void> {
    const drawing = ++this.drawing;
    this.updatePanel();
    const shown = this.shown ? [this.shown, ...(this.beside ? [this.beside] : [])] : [];
    const panes = shown.length > 0
      ? await Promise.all(shown.map((answer) => this.paneOf(answer, shown.length > 1 ? `answer ${answer.number}: ${answer.parameters.summary}` : "")))
      : [this.paneOfScan()];
    if (drawing !== this.drawing) return;  // another one has begun
    this.viewer.show(panes);
    if (look) this.viewer.look(this.boxOf(this.shown));
  }

  private paneOfScan(): Pane {
    const pane = emptyPane();
    const sensorPose = this.scan?.sensorPose;
    if (this.scan) pane.content.add(scanObject(moved(this.scan.points, matrixOf(sensorPose)), sensorPose !== undefined));
    return pane;
  }

  private async paneOf(answer: Answer, title: string): Promise<Pane> {
    const pane = emptyPane(title);
    const { response, scan, parameters } = answer;
    if (this.layers.has("scan")) pane.content.add(scanObject(moved(scan.points, matrixOf(response.sensorPose)), response.worldFrameSource !== WorldFrameSource.SENSOR));
    const region = parameters.searched;
    if (this.layers.has("region") && region?.min && region.max) {
      pane.content.add(boxObject(new Vector3(region.min.x, region.min.y, region.min.z), new Vector3(region.max.x, region.max.y, region.max.z), "#5b8def"));
    }
    await Promise.all(response.detections.map(async (detection, i) => {
      const group = new Group();
      const isSelected = answer === this.shown && i === this.selected;
      const key = `${answer.number}:${i}`;
      const color = colors[tone(detection)]!;
      if (detection.centroid) {
        // Above the object, whose centroid is about halfway up from the table.
        const at = new Vector3(detection.centroid.x, detection.centroid.y, 2 * detection.centroid.z + 0.01);
        pane.labels.push({ at, text: `${objectName(detection)} ${detection.score.toFixed(2)}`, key, tone: `${tone(detection)}${isSelected ? " selected" : ""}` });
      }
      if (detection.view !== "" && (this.layers.has("refined pose") || this.layers.has("rough pose"))) {
        const points = await pointsInObjectFrame(detection.view).catch(() => undefined);  // deleted meanwhile
        if (points && this.layers.has("rough pose")) group.add(cloudObject(moved(points, matrixOf(detection.roughPose)), "#c58af9", 2, key));
        if (points && this.layers.has("refined pose")) group.add(cloudObject(moved(points, matrixOf(detection.refinedPose)), color, isSelected ? 4 : 3, key));
      }
      if (this.layers.has("grasps")) {
        for (const grasp of detection.grasps.slice(0, isSelected ? maxGrasps : 1)) {
          const { gripperOpeningM, approachDistanceM } = taughtGrasp(grasp);
          group.add(gripperObject(matrixOf(grasp.tcpPose), gripperOpeningM, approachDistanceM, "#f08a24"));
        }
      }
      if (this.layers.has("axes") && detection.refinedPose) group.add(axesObject(matrixOf(detection.refinedPose), 0.06));
      pane.content.add(group);
    }));
    if (this.layers.has("axes")) pane.content.add(axesObject(new Matrix4(), 0.1));
    return pane;
  }

  // What to look at: the detections, or most of the points.
  private boxOf(answer: Answer | undefined): Box3 {
    const box = new Box3();
    for (const { centroid } of answer?.response.detections ?? []) {
      if (centroid) box.expandByPoint(new Vector3(centroid.x, centroid.y, centroid.z));
    }
    if (!box.isEmpty()) return box.expandByScalar(0.08);
    if (!this.scan) return box;
    const points = moved(this.scan.points, matrixOf(answer ? answer.response.sensorPose : this.scan.sensorPose));
    for (const axis of [0, 1, 2] as const) {
      const values = [];
      for (let i = axis; i < points.length; i += 3 * Math.max(1, Math.floor(points.length / 30_000))) values.push(points[i]!);
      values.sort((a, b) => a - b);
      box.min.setComponent(axis, values[Math.floor(values.length * 0.05)] ?? 0);
      box.max.setComponent(axis, values[Math.floor(values.length * 0.95)] ?? 0);
    }
    return box;
  }
}
