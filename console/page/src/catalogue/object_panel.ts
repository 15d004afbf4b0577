// What there is to see and to do about an object as a whole: labels, release, history, deletion and the way back.
import { EditKind, type ObjectRevision, type ResourceEdit } from "../../gen/graspdb/v1/object_history_service_pb";
import { ReleaseState, type Object$ as CatalogObject } from "../../gen/graspdb/v1/catalog_pb";
import { objectHistory } from "../base/api";
import { deleteObject, purge, releaseObject, restore, saveLabels, undelete, type Edit } from "./catalogue_edits";
import { facts, h, replace } from "../base/dom";
import { count, lastPart, utc } from "../base/text";

const pageSize = 50;

const kinds: Record<EditKind, string> = {
  [EditKind.UNSPECIFIED]: "changed", [EditKind.CREATED]: "created", [EditKind.UPDATED]: "changed", [EditKind.DELETED]: "deleted",
};

const collections: Record<string, string> = { objects: "object", stablePoses: "stable pose", views: "view" };

// "objects/mug/stablePoses/upright" as ["stable pose", "upright"].
function resourceOf(name: string): [string, string] {
  const parts = name.split("/");
  return [collections[parts.at(-2) ?? ""] ?? "record", parts.at(-1) ?? ""];
}

// Edits in words: views are counted, others named.
export function editTexts(edits: ResourceEdit[], editCount: number): string[] {
  const out: string[] = [];
  const views = new Map<EditKind, number>();
  for (const edit of edits) {
    const [kind, id] = resourceOf(edit.name);
    if (kind === "view") views.set(edit.kind, (views.get(edit.kind) ?? 0) + 1);
    else out.push(`${kind} ${id} ${kinds[edit.kind]}${edit.fields.length > 0 ? `: ${edit.fields.join(", ")}` : ""}`);
  }
  for (const [kind, size] of views) out.push(`${size} view${size === 1 ? "" : "s"} ${kinds[kind]}`);
  if (editCount > edits.length) out.push(`${count(editCount - edits.length)} more`);
  return out;
}

const isDeletion = (revision: ObjectRevision, object: string): boolean =>
  revision.edits.some((each) => each.name === object && each.kind === EditKind.DELETED);

export class ObjectPanel {
  readonly element = h("div", {});
  private readonly list = h("div", { className: "history" });
  private object: CatalogObject | undefined;
  private revisions: ObjectRevision[] = [];
  private nextPage = "";
  private step = 0;

  // `run`: carries an edit out, and reads the catalogue again.
  constructor(private readonly run: (edit: Edit) => Promise<void>, private readonly attempt: (action: () => Promise<void>) => Promise<void>) {}

  // Shows it, and reads its history.
  async show(object: CatalogObject): Promise<void> {
    this.object = object;
    this.revisions = [];
    this.nextPage = "";
    replace(this.list);
    replace(this.element, object.deleteTime ? this.ofDeleted(object) : this.ofObject(object),
      h("h3", {}, "History"), h("p", { className: "hint" }, "The newest change first. Times in UTC."), this.list);
    await this.readMore();
  }

  private button(text: string, edit: Edit, className = ""): HTMLElement {
    return h("button", { type: "button", className, onclick: () => void this.run(edit) }, text);
  }

  private ofDeleted(object: CatalogObject): HTMLElement {
    return h("div", {}, h("h2", {}, object.displayName || lastPart(object.name)),
      facts([["object", lastPart(object.name)], ["state", "deleted"], ["deleted (UTC)", utc(object.deleteTime)], ["kept until (UTC)", utc(object.purgeTime)]]),
      h("p", { className: "hint" }, "Its stable poses, views and outcomes of grasps come back with it."),
      this.button("Bring it back", () => undelete(object), "primary"),
      h("p", {}, this.button("Delete it for good …", () => purge(object), "danger")));
  }

  private ofObject(object: CatalogObject): HTMLElement {
    const isDraft = object.release === ReleaseState.DRAFT;
    const labels = h("input", { type: "text", id: "labels", value: object.labels.join(" "), spellcheck: false, autocomplete: "off" });
    return h("div", {}, h("h2", {}, object.displayName || lastPart(object.name)),
      facts([["object", lastPart(object.name)], ["state", isDraft ? "draft" : "released"], ["created (UTC)", utc(object.createTime)], ["changed (UTC)", utc(object.updateTime)]]),
      h("h3", {}, "Labels"),
      h("form", {
        className: "labels-of", noValidate: true, onsubmit: (event: Event) => {
          event.preventDefault();
          void this.run(() => saveLabels(object, labels.value.split(/[\s,]+/).filter((each) => each !== "")));
        },
      }, h("label", { for: "labels" }, "Separated by spaces. A cell with labels recognises only objects with one of them."),
      h("div", { className: "row" }, labels, h("button", { type: "submit" }, "Save the labels"))),
      h("h3", {}, "Release"),
      h("p", { className: "hint" }, isDraft ? "A draft: only cells with drafts recognise it." : "Cells recognise it. Make it a draft to keep it for test cells."),
      h("p", {}, isDraft
        ? this.button("Release the object …", () => releaseObject(object, ReleaseState.RELEASED))
        : this.button("Make it a draft …", () => releaseObject(object, ReleaseState.DRAFT))),
      h("h3", {}, "Delete"),
      h("p", {}, this.button("Delete the object …", () => deleteObject(object), "danger")));
  }

  private async readMore(): Promise<void> {
    const { object } = this;
    if (!object) return;
    const step = ++this.step;
    const page = await objectHistory.listObjectRevisions({ parent: object.name, pageSize, pageToken: this.nextPage });
    if (step !== this.step) return;
    this.revisions.push(...page.revisions);
    this.nextPage = page.nextPageToken;
    replace(this.list, this.revisions.map((each, i) => this.row(object, each, i)),
      this.revisions.length === 0 && h("p", { className: "hint" }, "The server keeps no earlier revision of it."),
      this.nextPage !== "" && h("button", { type: "button", onclick: () => void this.attempt(() => this.readMore()) }, "Earlier changes"));
  }

  private row(object: CatalogObject, revision: ObjectRevision, i: number): HTMLElement {
    const isPresent = i === 0;
    return h("div", { className: "detection" },
      h("div", { className: "row" },
        h("div", { className: "pick" }, h("strong", {}, `revision ${revision.revision}`),
          h("small", {}, `${utc(revision.changeTime)} · ${revision.method || "the server itself"}${revision.identity === "" ? "" : ` by ${revision.identity}`}`)),
        isPresent || isDeletion(revision, object.name)
          ? h("span", { className: "hint" }, isPresent ? "now" : "")
          : h("button", { type: "button", onclick: () => void this.run(() => restore(object, revision, i)), title: `Go back to revision ${revision.revision}` }, "Go back …")),
      editTexts(revision.edits, Number(revision.editCount)).map((each) => h("p", { className: "hint" }, each)));
  }
}
