// The settings of a request, as a form.
import { create } from "@bufbuild/protobuf";
import { AxisAlignedBoxSchema, type AxisAlignedBox } from "../../gen/graspdb/v1/geometry_pb";
import { PipelineParametersSchema, type Cell, type PipelineParameters } from "../../gen/graspdb/v1/cell_pb";
import type { RecognizeRequest } from "../../gen/graspdb/v1/recognition_service_pb";
import type { Camera } from "../files/depth_file";
import { h } from "../base/dom";
import { showCells } from "../base/cell_options";
import { lastPart } from "../base/text";

// `region`: of the request; `searched`: that one, or the cell's, if known.
export interface Parameters {
  cell: string;
  segmented: boolean;
  region?: AxisAlignedBox;
  searched?: AxisAlignedBox;
  pipeline?: PipelineParameters;
  summary: string;
}

type Key = "minScore" | "clusterToleranceM" | "minClusterPointCount" | "planeDistanceM" | "maxRangeM" | "maxObjectSizeM"
  | "verifiedViewCount" | "furtherViewCount";
interface Setting { key: Key; label: string; unit: string; least: number; most: number; standard: number; step: number }

// Ranges and defaults as PipelineParameters documents them.
const settings: Setting[] = [
  { key: "minScore", label: "minimum score", unit: "", least: 0, most: 1, standard: 0.5, step: 0.05 },
  { key: "clusterToleranceM", label: "cluster tolerance", unit: "m", least: 0.003, most: 0.2, standard: 0.015, step: 0.001 },
  { key: "minClusterPointCount", label: "least points of a cluster", unit: "", least: 10, most: 100000, standard: 50, step: 1 },
  { key: "planeDistanceM", label: "table up to", unit: "m", least: 0.0005, most: 0.1, standard: 0.006, step: 0.0005 },
  { key: "maxRangeM", label: "range", unit: "m", least: 0.1, most: 100, standard: 10, step: 0.1 },
  { key: "maxObjectSizeM", label: "longest object", unit: "m", least: 0.01, most: 5, standard: 1, step: 0.01 },
  { key: "verifiedViewCount", label: "views that are verified", unit: "", least: 1, most: 100, standard: 20, step: 1 },
  { key: "furtherViewCount", label: "further views", unit: "", least: 0, most: 10000, standard: 300, step: 1 },
];

const numberIn = (input: HTMLInputElement): number | undefined =>
  input.value.trim() === "" || !Number.isFinite(input.valueAsNumber) ? undefined : input.valueAsNumber;

// The settings that are given.
export const givenOf = (pipeline: PipelineParameters | undefined): Partial<Record<Key, number>> =>
  Object.fromEntries(settings.map(({ key }) => [key, pipeline?.[key]] as const).filter(([, value]) => value !== undefined));

export class ParameterForm {
  readonly element: HTMLElement;
  private readonly cell = h("select", { id: "cell" }, h("option", { value: "" }, "none"));
  private readonly segmented = h("input", { type: "checkbox", id: "segmented" });
  private readonly inputs = new Map<Key, HTMLInputElement>();
  private readonly region: HTMLInputElement[];
  private readonly camera: Record<keyof Camera, HTMLInputElement>;
  private cells: Cell[] = [];
  private wanted = "";  // the cell to choose as soon as the cells are known

  constructor() {
    const field = (id: string, label: string, input: HTMLElement, unit = "") =>
      h("div", { className: "field" }, h("label", { for: id }, label), input, unit !== "" && h("span", { className: "unit" }, unit));
    const fields = settings.map((setting) => {
      const input = h("input", {
        id: setting.key, type: "number", min: String(setting.least), max: String(setting.most), step: "any",
        placeholder: String(setting.standard),
      });
      this.inputs.set(setting.key, input);
      return field(setting.key, setting.label, input, setting.unit);
    });
    this.region = ["x from", "y from", "z from", "x to", "y to", "z to"].map((label) => {
      const input = h("input", { type: "number", step: "any" });
      input.setAttribute("aria-label", `region, ${label}`);
      return input;
    });
    const cameraInput = (id: string, placeholder = ""): HTMLInputElement =>
      h("input", { id, type: "number", step: "any", placeholder });
    this.camera = {
      fx: cameraInput("fx"), fy: cameraInput("fy"), cx: cameraInput("cx"), cy: cameraInput("cy"),
      depthUnitM: cameraInput("depthUnitM", "0.001"),
    };
    const [x0, y0, z0, x1, y1, z1] = this.region;
    this.element = h("div", { className: "parameters" },
      field("cell", "cell", this.cell),
      field("segmented", "the object's points alone", this.segmented),
      fields.slice(0, 1),
      h("details", { open: false }, h("summary", {}, "Region (m, world frame)"),
        h("div", { className: "region" }, h("span", {}, ""), h("span", {}, "x"), h("span", {}, "y"), h("span", {}, "z"),
          h("span", {}, "from"), x0, y0, z0, h("span", {}, "to"), x1, y1, z1)),
      h("details", {}, h("summary", {}, "Pipeline"), fields.slice(1)),
      h("details", {}, h("summary", {}, "Camera of a depth image"),
        field("fx", "fx", this.camera.fx, "px"), field("fy", "fy", this.camera.fy, "px"),
        field("cx", "cx", this.camera.cx, "px"), field("cy", "cy", this.camera.cy, "px"),
        field("depthUnitM", "depth unit", this.camera.depthUnitM, "m")));
  }

  setCells(cells: Cell[]): void {
    this.cells = cells;
    showCells(this.cell, cells, this.wanted || this.cell.value);
    this.wanted = "";
  }

  setSegmented(segmented: boolean): void {
    this.segmented.checked = segmented;
  }

  // As a recorded request has them, so that it can be sent again.
  setRequest(request: RecognizeRequest): void {
    this.cell.value = this.cells.some((each) => each.name === request.cell) ? request.cell : "";
    this.wanted = this.cell.value === "" ? request.cell : "";
    for (const { key } of settings) this.inputs.get(key)!.value = request.pipeline?.[key] === undefined ? "" : String(request.pipeline[key]);
    const { min, max } = request.regionOfInterest ?? {};
    const corner = [min?.x, min?.y, min?.z, max?.x, max?.y, max?.z];
    this.region.forEach((input, i) => (input.value = corner[i] === undefined ? "" : String(corner[i])));
  }

  cameraOf(): Camera | undefined {
    const { fx, fy, cx, cy, depthUnitM } = this.camera;
    const [a, b, c, d] = [fx, fy, cx, cy].map(numberIn);
    if (a === undefined || b === undefined || c === undefined || d === undefined) return undefined;
    return { fx: a, fy: b, cx: c, cy: d, depthUnitM: numberIn(depthUnitM) ?? 0.001 };
  }

  // Throws where a value cannot be used.
  read(): Parameters {
    const words: string[] = [];
    if (this.cell.value !== "") words.push(lastPart(this.cell.value));
    const corner = this.region.map(numberIn);
    let region: AxisAlignedBox | undefined;
    if (corner.some((value) => value !== undefined)) {
      const [x0, y0, z0, x1, y1, z1] = corner;
      if (x0 === undefined || y0 === undefined || z0 === undefined || x1 === undefined || y1 === undefined || z1 === undefined) {
        throw new Error("the region needs all six numbers, or none");
      }
      region = create(AxisAlignedBoxSchema, { min: { x: x0, y: y0, z: z0 }, max: { x: x1, y: y1, z: z1 } });
      words.push("region");
    }
    const pipeline = create(PipelineParametersSchema);
    let isSet = false;
    for (const { key, label, least, most, unit } of settings) {
      const input = this.inputs.get(key)!;
      const value = numberIn(input);
      if (value === undefined) continue;
      if (value < least || value > most) throw new Error(`${label}: ${least} to ${most}`);
      pipeline[key] = value;
      isSet = true;
      words.push(`${label} ${value}${unit === "" ? "" : ` ${unit}`}`);
    }
    return {
      cell: this.cell.value, segmented: this.segmented.checked, region,
      searched: region ?? this.cells.find((each) => each.name === this.cell.value)?.regionOfInterest,
      pipeline: isSet ? pipeline : undefined,
      summary: words.length === 0 ? "defaults" : words.join(", "),
    };
  }
}
