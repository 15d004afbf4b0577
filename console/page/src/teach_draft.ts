// A draft in the catalogue: a stable pose that only cells with drafts recognise, until it is released.
import { Code, ConnectError } from "@connectrpc/connect";
import { ReleaseState, type Grasp, type StablePose } from "../gen/graspdb/v1/catalog_pb";
import { catalog } from "./api";

export interface DraftRequest { objectId: string; displayName: string; stablePoseId: string; symmetryOrder: number; grasps: Grasp[] }

const isCode = (error: unknown, code: Code): boolean => ConnectError.from(error).code === code;

// Creates the stable pose as a draft, and its object where there is none. A draft of that name is taken as it is. Throws
// where the stable pose is released: cells would recognise its new views at once.
export async function makeDraft(request: DraftRequest): Promise<StablePose> {
  const parent = `objects/${request.objectId}`;
  try {
    await catalog.createObject({ objectId: request.objectId, object: { displayName: request.displayName, release: ReleaseState.DRAFT } });
  } catch (error) {
    if (!isCode(error, Code.AlreadyExists)) throw error;
  }
  try {
    return await catalog.createStablePose({
      parent, stablePoseId: request.stablePoseId,
      stablePose: { symmetryOrder: request.symmetryOrder, grasps: request.grasps, release: ReleaseState.DRAFT },
    });
  } catch (error) {
    if (!isCode(error, Code.AlreadyExists)) throw error;
  }
  const name = `${parent}/stablePoses/${request.stablePoseId}`;
  const [pose, object] = await Promise.all([catalog.getStablePose({ name }), catalog.getObject({ name: parent })]);
  if (pose.release !== ReleaseState.DRAFT && object.release !== ReleaseState.DRAFT) {
    throw new Error(`${name} is released: cells would recognise its new views at once. Give the new stable pose another id`);
  }
  return pose;
}

// With its object, if that is a draft.
export async function releaseDraft(pose: StablePose): Promise<void> {
  await catalog.updateStablePose({ stablePose: { name: pose.name, release: ReleaseState.RELEASED }, updateMask: { paths: ["release"] } });
  const object = await catalog.getObject({ name: objectOf(pose) });
  if (object.release !== ReleaseState.DRAFT) return;
  await catalog.updateObject({ object: { name: object.name, release: ReleaseState.RELEASED, etag: object.etag }, updateMask: { paths: ["release"] } });
}

// With its object, if that is a draft without other stable poses.
export async function deleteDraft(pose: StablePose): Promise<void> {
  await catalog.deleteStablePose({ name: pose.name, force: true });
  const object = await catalog.getObject({ name: objectOf(pose) });
  if (object.release !== ReleaseState.DRAFT) return;
  try {
    await catalog.deleteObject({ name: object.name, etag: object.etag });
  } catch (error) {
    if (!isCode(error, Code.FailedPrecondition)) throw error;  // it has others
  }
}

const objectOf = (pose: StablePose): string => pose.name.split("/").slice(0, 2).join("/");
