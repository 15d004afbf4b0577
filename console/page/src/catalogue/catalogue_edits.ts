// Changes of the catalogue that its view offers. Those that take something away or that cells notice need a confirmation. Each
// resolves with what was done in words; undefined: it was declined. An etag guards each record that is shown: where another one
// has changed it meanwhile, the server refuses (ABORTED).
import { ReleaseState, type Object$ as CatalogObject, type StablePose, type View } from "../../gen/graspdb/v1/catalog_pb";
import type { ObjectRevision } from "../../gen/graspdb/v1/object_history_service_pb";
import { catalog, objectHistory } from "../base/api";
import { confirmed } from "../base/confirm";
import { lastPart, shortName, utc } from "../base/text";

export type Edit = () => Promise<string | undefined>;

const release = { updateMask: { paths: ["release"] } };
const releaseText = (name: string, state: ReleaseState): string[] => state === ReleaseState.DRAFT
  ? [`Cells no longer recognise ${name} from their next frame on, except those with drafts. Its views and grasps stay.`]
  : [`All cells recognise ${name} from their next frame on, unless their labels leave it out.`];
const titleOf = (name: string, state: ReleaseState): string => state === ReleaseState.DRAFT ? `Make ${name} a draft?` : `Release ${name}?`;
const actionOf = (state: ReleaseState): string => state === ReleaseState.DRAFT ? "Make it a draft" : "Release it";
const doneText = (name: string, state: ReleaseState): string => `${name} is ${state === ReleaseState.DRAFT ? "a draft" : "released"}.`;

export async function releaseObject(object: CatalogObject, state: ReleaseState): Promise<string | undefined> {
  const name = lastPart(object.name);
  if (!await confirmed({ title: titleOf(name, state), text: [...releaseText(name, state), "Stable poses that are drafts themselves stay drafts."], action: actionOf(state) })) return undefined;
  await catalog.updateObject({ object: { name: object.name, release: state, etag: object.etag }, ...release });
  return doneText(name, state);
}

export async function releasePose(pose: StablePose, state: ReleaseState): Promise<string | undefined> {
  const name = shortName(pose.name);
  if (!await confirmed({ title: titleOf(name, state), text: releaseText(name, state), action: actionOf(state) })) return undefined;
  await catalog.updateStablePose({ stablePose: { name: pose.name, release: state, etag: pose.etag }, ...release });
  return doneText(name, state);
}

export async function saveLabels(object: CatalogObject, labels: string[]): Promise<string> {
  await catalog.updateObject({ object: { name: object.name, labels, etag: object.etag }, updateMask: { paths: ["labels"] } });
  return `The labels of ${lastPart(object.name)} are saved.`;
}

export async function deleteObject(object: CatalogObject): Promise<string | undefined> {
  const name = lastPart(object.name);
  const text = [`Deletes ${name} with its stable poses, grasps and views. No cell recognises it from its next frame on.`,
    "It can be brought back for as long as the server keeps deleted objects (--deleted-objects-kept)."];
  if (!await confirmed({ title: `Delete ${name}?`, text, action: "Delete the object" })) return undefined;
  await catalog.deleteObject({ name: object.name, force: true, etag: object.etag });
  return `${name} is deleted.`;
}

export async function deletePose(pose: StablePose): Promise<string | undefined> {
  const name = shortName(pose.name);
  const text = [`Deletes ${name} with its grasps and views. No cell recognises the object in this pose from its next frame on.`,
    "The history of the object can put it back, for as long as the server keeps earlier revisions."];
  if (!await confirmed({ title: `Delete ${name}?`, text, action: "Delete the stable pose" })) return undefined;
  await catalog.deleteStablePose({ name: pose.name, force: true, etag: pose.etag });
  return `${name} is deleted.`;
}

export async function deleteView(view: View): Promise<string | undefined> {
  const text = [`Deletes the view ${shortName(view.name)}. Recognition compares scans with the other views only.`,
    "The history of the object can put it back, for as long as the server keeps earlier revisions."];
  if (!await confirmed({ title: "Delete the view?", text, action: "Delete the view" })) return undefined;
  await catalog.deleteView({ name: view.name });
  return `The view ${lastPart(view.name)} is deleted.`;
}

export async function undelete(object: CatalogObject): Promise<string> {
  await objectHistory.undeleteObject({ name: object.name });
  return `${lastPart(object.name)} is back, with its stable poses and views.`;
}

export async function purge(object: CatalogObject): Promise<string | undefined> {
  const name = lastPart(object.name);
  const text = [`Deletes ${name} for good, with its stable poses, views and history. Only a backup has it then.`];
  if (!await confirmed({ title: `Delete ${name} for good?`, text, action: "Delete it for good" })) return undefined;
  await objectHistory.purgeObject({ name: object.name });
  return `${name} is deleted for good.`;
}

// `newer`: how many changes are newer.
export async function restore(object: CatalogObject, revision: ObjectRevision, newer: number): Promise<string | undefined> {
  const name = lastPart(object.name);
  const text = [
    `Puts ${name} with its stable poses and views back to their state after revision ${revision.revision} (${utc(revision.changeTime)} UTC). ` +
      `It undoes ${newer} change${newer === 1 ? "" : "s"} in one.`,
    "Labels, grasps and release states go back as well: what was released then is released. Outcomes of grasps that changed since start at zero.",
    "The present state stays in the history.",
  ];
  if (!await confirmed({ title: `Go back to revision ${revision.revision}?`, text, action: "Go back" })) return undefined;
  await objectHistory.restoreObject({ name: object.name, revision: revision.revision, etag: object.deleteTime ? "" : object.etag });
  return `${name} is as it was after revision ${revision.revision}.`;
}
