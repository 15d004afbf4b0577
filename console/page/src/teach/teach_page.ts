// The view for teaching: from captures, or from a mesh, by what is dropped.
import type { Explained } from "../base/api";
import { h, replace, takeDrops } from "../base/dom";
import { MeshTeachView } from "../mesh/mesh_view";
import { isMesh } from "./teach_captures";
import { TeachView } from "./teach_view";

export class TeachPage {
  readonly element = h("div", { className: "teaching" });
  private readonly drop: HTMLElement;
  private readonly captures: TeachView;
  private mesh: MeshTeachView | undefined;  // made with the first mesh, since browsers have few contexts of WebGL
  private shown: TeachView | MeshTeachView;

  constructor(private readonly report: (error: Explained | undefined) => void) {
    const input = h("input", {
      type: "file", id: "teach-files", multiple: true, accept: ".pcd,.ply,.png,.json,.stl,.obj",
      onclick: () => (input.value = ""),  // so that the same file may be chosen again
      onchange: () => void this.open([...(input.files ?? [])]),
    });
    this.drop = h("label", { className: "drop", for: input.id }, h("strong", {}, "Drop captures or a mesh, or choose them"),
      h("span", {}, "PCD, PLY, 16-bit PNG with intrinsics.json, or captures.json with its clouds. A mesh: STL, OBJ, PLY"), input);
    this.captures = new TeachView(report, this.drop);
    this.shown = this.captures;
    this.element.append(this.captures.element);
    takeDrops(this.element, (files) => void this.open(files));
  }

  opened(): void {
    this.shown.opened();
  }

  recolour(): void {
    this.shown.recolour();
  }

  private async open(files: File[]): Promise<void> {
    const meshes = (await Promise.all(files.map(isMesh))).map((each, i) => each ? files[i] : undefined).filter((each) => each !== undefined);
    // A capture set has its meshes beside the clouds.
    const isSet = files.some((each) => each.name === "captures.json" || /\.(pcd|png)$/i.test(each.name));
    const mesh = isSet ? undefined : meshes[0];
    if (mesh) {
      this.mesh ??= new MeshTeachView(this.report);
      this.show(this.mesh);
      return this.mesh.open(mesh);
    }
    this.show(this.captures);
    return this.captures.open(files.filter((each) => !meshes.includes(each)));
  }

  private show(view: TeachView | MeshTeachView): void {
    if (this.shown === view) return;
    this.shown = view;
    view.element.querySelector("aside")?.prepend(this.drop);
    replace(this.element, view.element);
    view.opened();
  }
}
