// Chooses a stable pose: an object, and one of its stable poses.
import type { Object$ as CatalogObject, StablePose } from "../../gen/graspdb/v1/catalog_pb";
import { listObjects, listStablePoses } from "./api";
import { h, replace } from "./dom";
import { lastPart } from "./text";

const maxObjects = 2000;
const maxPoses = 100;

const optionOf = (each: CatalogObject | StablePose): HTMLOptionElement =>
  h("option", { value: each.name }, each.displayName || lastPart(each.name));

export class PosePicker {
  readonly element: HTMLElement;
  private readonly object = h("select", { id: "picked-object", onchange: () => void this.attempt(() => this.choose(this.object.value, "")) });
  private readonly pose = h("select", { id: "picked-pose", onchange: () => void this.attempt(() => this.chosen(this.pose.value)) });
  private step = 0;

  // `chosen`: with the name of the stable pose, empty without one.
  constructor(private readonly chosen: (name: string) => Promise<void>, private readonly attempt: (action: () => Promise<void>) => Promise<void>) {
    const field = (id: string, label: string, input: HTMLElement): HTMLElement => h("div", { className: "field" }, h("label", { for: id }, label), input);
    this.element = h("div", { className: "picker" }, field("picked-object", "object", this.object), field("picked-pose", "stable pose", this.pose));
  }

  setDisabled(disabled: boolean): void {
    this.object.disabled = disabled;
    this.pose.disabled = disabled;
  }

  // Reads the objects again. `pose`: the stable pose to choose; empty: the one that is chosen, or else the first.
  async open(pose: string): Promise<void> {
    const step = ++this.step;
    const objects = await listObjects(maxObjects);
    if (step !== this.step) return;
    const before = pose || this.pose.value;
    replace(this.object, objects.map(optionOf));
    const object = objects.find((each) => before.startsWith(`${each.name}/`)) ?? objects[0];
    await this.choose(object?.name ?? "", before);
  }

  private async choose(object: string, pose: string): Promise<void> {
    const step = ++this.step;
    const poses = object === "" ? [] : await listStablePoses(object, maxPoses);
    if (step !== this.step) return;
    this.object.value = object;
    replace(this.pose, poses.map(optionOf));
    this.pose.value = poses.some((each) => each.name === pose) ? pose : poses[0]?.name ?? "";
    await this.chosen(this.pose.value);
  }
}
