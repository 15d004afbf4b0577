// The descriptors of a view as plots: the histograms by which it is found.
import type { ViewDescriptor } from "../../gen/graspdb/v1/catalog_pb";
import { catalog, describedView } from "../base/api";
import { h, replace } from "../base/dom";
import { styleColor } from "../base/viewer";

// A part of a descriptor: one histogram, or one of two dimensions with `columns`, its lowest row first.
interface Part { title: string; bins: number; columns?: number }

// As recognition/descriptors orders the bins. A descriptor that is not here is drawn in one piece.
const layouts: Record<string, Part[]> = {
  vfh263: [{ title: "cos α", bins: 45 }, { title: "cos φ", bins: 45 }, { title: "θ", bins: 45 }, { title: "viewpoint", bins: 128 }],
  mvfh300: [
    { title: "cos α", bins: 45 }, { title: "cos φ", bins: 45 }, { title: "θ", bins: 45 },
    { title: "viewpoint cos α", bins: 55 }, { title: "cos φ", bins: 55 }, { title: "θ", bins: 55 },
  ],
  vfh308: [
    { title: "θ", bins: 45 }, { title: "α", bins: 45 }, { title: "φ", bins: 45 }, { title: "distance", bins: 45 }, { title: "viewpoint", bins: 128 },
  ],
  gsh288: [
    { title: "normals, by azimuth and slope", bins: 96, columns: 16 }, { title: "points, from the camera", bins: 96, columns: 12 },
    { title: "points, from the side", bins: 96, columns: 12 },
  ],
};

function partsOf(descriptor: ViewDescriptor): Part[] {
  const known = layouts[descriptor.name];
  const isWhole = known?.reduce((sum, part) => sum + part.bins, 0) === descriptor.bins.length;
  return known && isWhole ? known : [{ title: "", bins: descriptor.bins.length }];
}

function drawBars(bins: number[], highest: number): HTMLCanvasElement {
  const canvas = h("canvas", { width: 4 * bins.length, height: 64 });
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = styleColor("--high");
  bins.forEach((bin, i) => {
    const height = (bin / highest) * canvas.height;
    pen.fillRect(4 * i, canvas.height - height, 3, height);
  });
  return canvas;
}

function drawGrid(bins: number[], columns: number, highest: number): HTMLCanvasElement {
  const rows = bins.length / columns;
  const canvas = h("canvas", { width: 8 * columns, height: 8 * rows });
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = styleColor("--high");
  bins.forEach((bin, i) => {
    pen.globalAlpha = bin / highest;
    pen.fillRect(8 * (i % columns), 8 * (rows - 1 - Math.floor(i / columns)), 8, 8);
  });
  return canvas;
}

function plot(descriptor: ViewDescriptor, isUsed: boolean): HTMLElement {
  const highest = Math.max(...descriptor.bins, Number.MIN_VALUE);
  let at = 0;
  const parts = partsOf(descriptor).map(({ title, bins: size, columns }) => {
    const bins = descriptor.bins.slice(at, at += size);
    const canvas = columns ? drawGrid(bins, columns, highest) : drawBars(bins, highest);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${descriptor.name} ${title}`);
    const part = h("figure", {}, canvas, h("figcaption", {}, title));
    part.style.flexGrow = String(size);
    return part;
  });
  return h("section", {}, h("h4", {}, descriptor.name, h("small", {}, `${descriptor.bins.length} bins${isUsed ? ", finds the views" : ""}`)),
    h("div", { className: "parts" }, parts));
}

export class DescriptorPlots {
  readonly element = h("div", { className: "descriptors" }, h("p", { className: "hint" }, "Computing the descriptors …"));
  private descriptors: ViewDescriptor[] = [];
  private used = "";

  async load(view: string): Promise<void> {
    try {
      const [described, { descriptorName }] = await Promise.all([describedView(view), catalog.getCatalogStatus({})]);
      this.descriptors = described.descriptors;
      this.used = descriptorName;
    } catch (error) {
      replace(this.element, h("p", { className: "hint" }, "They could not be computed."));
      throw error;
    }
    if (this.descriptors.length > 0) this.draw();
    else replace(this.element, h("p", { className: "hint" }, "There are no descriptors: the points are too few, or the server is older."));
  }

  draw(): void {
    if (this.descriptors.length === 0) return;
    const first = (each: ViewDescriptor): number => Number(each.name !== this.used);
    replace(this.element, [...this.descriptors].sort((a, b) => first(a) - first(b)).map((each) => plot(each, each.name === this.used)));
  }
}
