// The fields of one grasp, as a form.
import { clone, create } from "@bufbuild/protobuf";
import { GraspSchema, Grasp_FreeTurnSchema, type Grasp } from "../../gen/graspdb/v1/catalog_pb";
import { h } from "../base/dom";
import { numbersOfPose, poseLabels, poseOfNumbers } from "../base/geometry";

const rounded = (value: number): string => String(Math.round(value * 100) / 100);
const titles: Record<string, string> = {
  roll: "turn about x of the object's frame, then", pitch: "about y, then", yaw: "about z",
};

export class GraspForm {
  readonly element: HTMLElement;
  private readonly id = h("input", { id: "grasp-id", type: "text", spellcheck: false });
  private readonly pose: HTMLInputElement[];
  private readonly opening = this.number("grasp-opening");
  private readonly approach = this.number("grasp-approach");
  private readonly retreat = this.number("grasp-retreat");
  private readonly priority = this.number("grasp-priority");
  private readonly turns = h("input", { type: "checkbox", id: "grasp-turns" });
  private readonly minTurn = this.number("grasp-min-turn");
  private readonly maxTurn = this.number("grasp-max-turn");
  private grasp: Grasp | undefined;

  // `changed`: with the grasp as it is after a person changed a field.
  constructor(private readonly changed: (grasp: Grasp) => void) {
    const field = (input: HTMLElement, label: string, unit = ""): HTMLElement => h("div", { className: "field" },
      h("label", { for: input.id }, label), input, unit !== "" && h("span", { className: "unit" }, unit));
    this.pose = poseLabels.map((label) => this.number(`grasp-${label}`, titles[label]));
    this.element = h("form", { className: "grasp-form", noValidate: true, onsubmit: (event: Event) => event.preventDefault(), oninput: () => this.take() },
      field(this.id, "id"),
      h("h3", {}, "Tool centre point, in the object's frame"),
      this.pose.map((input, i) => field(input, poseLabels[i]!, i < 3 ? "mm" : "°")),
      h("h3", {}, "Gripper"),
      field(this.opening, "opening", "mm"), field(this.approach, "approach", "mm"), field(this.retreat, "retreat upwards", "mm"),
      field(this.priority, "priority"),
      field(this.turns, "may be turned about z"), field(this.minTurn, "from", "°"), field(this.maxTurn, "to", "°"));
  }

  private number(id: string, title?: string): HTMLInputElement {
    return h("input", { id, type: "number", step: "any", title });
  }

  // What a person types is not replaced while it stays the same number.
  private static set(input: HTMLInputElement, value: number): void {
    if (input.value === "" || Math.abs(input.valueAsNumber - value) > 0.005) input.value = rounded(value);
  }

  show(grasp: Grasp): void {
    const isOther = grasp.graspId !== this.id.value;
    this.grasp = grasp;
    if (isOther) this.id.value = grasp.graspId;
    numbersOfPose(grasp.tcpPose).forEach((value, i) => GraspForm.set(this.pose[i]!, value));
    GraspForm.set(this.opening, grasp.gripperOpeningM * 1000);
    GraspForm.set(this.approach, grasp.approachDistanceM * 1000);
    GraspForm.set(this.retreat, grasp.retreatDistanceM * 1000);
    GraspForm.set(this.priority, grasp.priority);
    this.turns.checked = grasp.freeTurn !== undefined;
    GraspForm.set(this.minTurn, grasp.freeTurn?.minDeg ?? -180);
    GraspForm.set(this.maxTurn, grasp.freeTurn?.maxDeg ?? 180);
    this.minTurn.disabled = this.maxTurn.disabled = grasp.freeTurn === undefined;
  }

  // Nothing changes while a number is missing or cut off.
  private take(): void {
    const numbers = [...this.pose, this.opening, this.approach, this.retreat, this.priority, this.minTurn, this.maxTurn].map((input) => input.valueAsNumber);
    if (!this.grasp || numbers.some((value) => !Number.isFinite(value))) return;
    const [opening, approach, retreat, priority, minDeg, maxDeg] = numbers.slice(6) as [number, number, number, number, number, number];
    const grasp = clone(GraspSchema, this.grasp);
    grasp.graspId = this.id.value;
    const before = numbersOfPose(grasp.tcpPose);
    // A pose that was not changed keeps its bits.
    if (numbers.slice(0, 6).some((value, i) => Math.abs(value - before[i]!) > 0.005)) grasp.tcpPose = poseOfNumbers(numbers.slice(0, 6));
    grasp.gripperOpeningM = opening / 1000;
    grasp.approachDistanceM = approach / 1000;
    grasp.retreatDistanceM = retreat / 1000;
    grasp.priority = Math.round(priority);
    grasp.freeTurn = this.turns.checked ? create(Grasp_FreeTurnSchema, { minDeg, maxDeg }) : undefined;
    this.grasp = grasp;
    this.minTurn.disabled = this.maxTurn.disabled = !this.turns.checked;
    this.changed(grasp);
  }
}
