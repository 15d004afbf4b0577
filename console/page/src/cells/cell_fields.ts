// Fields of a cell that may be absent: poses and boxes, as forms.
import { create } from "@bufbuild/protobuf";
import { AxisAlignedBoxSchema, type AxisAlignedBox, type Pose } from "../../gen/graspdb/v1/geometry_pb";
import { h } from "../base/dom";
import { numbersOfPose, poseLabels, poseOfNumbers } from "../base/geometry";

const smallest = 0.001;  // m, of a box

// A checkbox, whether there is a value, and its numbers.
abstract class Fields<T> {
  readonly element: HTMLElement;
  protected readonly isThere: HTMLInputElement;
  protected readonly inputs: HTMLInputElement[];
  private value: T | undefined;

  constructor(id: string, title: string, labels: readonly string[], unit: (i: number) => string, private readonly initial: T, changed: () => void) {
    const take = (): void => {
      this.take();
      changed();
    };
    this.isThere = h("input", { type: "checkbox", id, onchange: () => {
      this.set(this.isThere.checked ? this.initial : undefined);
      changed();
    } });
    this.inputs = labels.map((label, i) => h("input", { type: "number", step: "any", id: `${id}-${i}`, "aria-label": `${title}, ${label}`, oninput: take }));
    this.element = h("fieldset", { className: "cell-fields" }, h("legend", {}, h("label", {}, this.isThere, ` ${title}`)),
      h("div", { className: "numbers" }, this.inputs.map((input, i) => h("label", {}, `${labels[i]} `, h("span", { className: "unit" }, unit(i)), input))));
  }

  protected abstract numbersOf(value: T): number[];
  protected abstract of(numbers: number[]): T;

  get(): T | undefined {
    return this.value;
  }

  set(value: T | undefined): void {
    this.value = value;
    this.isThere.checked = value !== undefined;
    const numbers = value === undefined ? [] : this.numbersOf(value);
    this.inputs.forEach((input, i) => {
      input.disabled = value === undefined;
      const number = numbers[i];
      if (number === undefined) input.value = "";
      else if (input.value === "" || Math.abs(input.valueAsNumber - number) > 0.005) input.value = String(Math.round(number * 100) / 100);
    });
  }

  // Nothing changes while a number is missing; numbers that stay keep their bits.
  private take(): void {
    const numbers = this.inputs.map((input) => input.valueAsNumber);
    if (this.value === undefined || numbers.some((each) => !Number.isFinite(each))) return;
    const before = this.numbersOf(this.value);
    const merged = numbers.map((each, i) => Math.abs(each - before[i]!) > 0.005 ? each : before[i]!);
    if (merged.some((each, i) => each !== before[i])) this.value = this.of(merged);
  }
}

export class PoseFields extends Fields<Pose> {
  constructor(id: string, title: string, initial: Pose, changed: () => void) {
    super(id, title, poseLabels, (i) => i < 3 ? "mm" : "°", initial, changed);
  }
  protected numbersOf(value: Pose): number[] {
    return numbersOfPose(value);
  }
  protected of(numbers: number[]): Pose {
    return poseOfNumbers(numbers);
  }
}

export class BoxFields extends Fields<AxisAlignedBox> {
  constructor(id: string, title: string, initial: AxisAlignedBox, changed: () => void) {
    super(id, title, ["x from", "y from", "z from", "x to", "y to", "z to"], () => "mm", initial, changed);
  }
  protected numbersOf({ min, max }: AxisAlignedBox): number[] {
    return [min?.x, min?.y, min?.z, max?.x, max?.y, max?.z].map((each) => (each ?? 0) * 1000);
  }
  protected of(numbers: number[]): AxisAlignedBox {
    return boxOfNumbers(numbers.map((each) => each / 1000));
  }
}

// In metres: the smallest corner, then the largest.
export function boxOfNumbers(numbers: number[]): AxisAlignedBox {
  const [x0, y0, z0, x1, y1, z1] = numbers as [number, number, number, number, number, number];
  return create(AxisAlignedBoxSchema, { min: { x: x0, y: y0, z: z0 }, max: { x: x1, y: y1, z: z1 } });
}

// Of a dragged unit cube at `center`, `size` m along each axis.
export const draggedBox = (center: number[], size: number[]): AxisAlignedBox =>
  boxOfNumbers([-0.5, 0.5].flatMap((half) => center.map((each, i) => each + half * Math.max(smallest, Math.abs(size[i]!)))));
