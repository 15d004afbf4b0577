// The cells of the server in a list to choose from.
import type { Cell } from "../../gen/graspdb/v1/cell_pb";
import { h, replace } from "./dom";
import { lastPart } from "./text";

// Behind "none". `chosen`: the name of the cell that is chosen then, where it is still there.
export function showCells(select: HTMLSelectElement, cells: Cell[], chosen = select.value): void {
  replace(select, h("option", { value: "" }, "none"), cells.map((each) => h("option", { value: each.name }, lastPart(each.name))));
  select.value = cells.some((each) => each.name === chosen) ? chosen : "";
}
