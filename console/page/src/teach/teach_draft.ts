// A draft in the catalogue: a stable pose that only cells with drafts recognise, until it is released.
import { Code, ConnectError } from "@connectrpc/connect";
import { ReleaseState, type Grasp, type StablePose } from "../../gen/graspdb/v1/catalog_pb";
import type { Pose } from "../../gen/graspdb/v1/geometry_pb";
import { catalog } from "../base/api";

// `meshPose`: T_object_mesh of a mesh.
export interface DraftRequest { objectId: string; displayName: string; stablePoseId: string; symmetryOrder: number; grasps: Grasp[]; meshPose?: Pose }

const isCode = (error: unknown, code: Code): boolean => ConnectError.from(error).code === code;

// Creates an object as a draft where there is none.
async function makeObject(request: DraftRequest): Promise<void> {
  try {
    await catalog.createObject({ objectId: request.objectId, object: { displayName: request.displayName, release: ReleaseState.DRAFT } });
  } catch (error) {
    if (!isCode(error, Code.AlreadyExists)) throw error;
  }
}

// Creates the stable pose as a draft, and its object where there is none (`hasObject`: there is one). A draft of that name is taken as it
// is (`isNew`: there was none). Throws where the stable pose is released: cells would recognise its new views at once.
export async function makeDraft(request: DraftRequest, hasObject = false): Promise<{ draft: StablePose; isNew: boolean }> {
  const parent = `objects/${request.objectId}`;
  if (!hasObject) await makeObject(request);
  try {
    const draft = await catalog.createStablePose({
      parent, stablePoseId: request.stablePoseId,
      stablePose: { symmetryOrder: request.symmetryOrder, grasps: request.grasps, meshPose: request.meshPose, release: ReleaseState.DRAFT },
    });
    return { draft, isNew: true };
  } catch (error) {
    if (!isCode(error, Code.AlreadyExists)) throw error;
  }
  const name = `${parent}/stablePoses/${request.stablePoseId}`;
  const [pose, object] = await Promise.all([catalog.getStablePose({ name }), catalog.getObject({ name: parent })]);
  if (pose.release !== ReleaseState.DRAFT && object.release !== ReleaseState.DRAFT) {
    throw new Error(`${name} is released: cells would recognise its new views at once. Give the new stable pose another id`);
  }
  return { draft: pose, isNew: false };
}

// With its object, if that is a draft.
export async function releaseDraft(pose: StablePose): Promise<void> {
  await catalog.updateStablePose({ stablePose: { name: pose.name, release: ReleaseState.RELEASED }, updateMask: { paths: ["release"] } });
  const object = await catalog.getObject({ name: objectOf(pose) });
  if (object.release !== ReleaseState.DRAFT) return;
  await catalog.updateObject({ object: { name: object.name, release: ReleaseState.RELEASED, etag: object.etag }, updateMask: { paths: ["release"] } });
}

// Stable poses of one object, and that if it is a draft without others.
export async function deleteDrafts(poses: StablePose[]): Promise<void> {
  if (!poses[0]) return;
  for (const { name } of poses) await catalog.deleteStablePose({ name, force: true });
  const object = await catalog.getObject({ name: objectOf(poses[0]) });
  if (object.release !== ReleaseState.DRAFT) return;
  try {
    await catalog.deleteObject({ name: object.name, etag: object.etag });
  } catch (error) {
    if (!isCode(error, Code.FailedPrecondition)) throw error;  // it has others
  }
}

const objectOf = (pose: StablePose): string => pose.name.split("/").slice(0, 2).join("/");
