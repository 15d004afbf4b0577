// Stores the views of a mesh as drafts by a bulk upload: all of them become part of the catalogue in one revision, or none.
import { Code, ConnectError } from "@connectrpc/connect";
import { Matrix4 } from "three";
import type { Grasp, StablePose } from "../../gen/graspdb/v1/catalog_pb";
import { listViews, uploads, writeUploadView } from "../base/api";
import { between, poseOf } from "../base/geometry";
import { viewIdOf } from "../teach/teach_captures";
import { deleteDrafts, makeDraft } from "../teach/teach_draft";
import { regionOf, worldObjectOf, type MeshView } from "./mesh_views";
import type { MeshStablePose } from "./stable_poses";
import { transformed, type TriangleMesh } from "./triangle_mesh";

export interface MeshToStore {
  objectId: string;
  displayName: string;
  mesh: TriangleMesh;
  poses: { pose: MeshStablePose; grasps: Grasp[] }[];
  views: MeshView[];
  worldSensor: Matrix4;
}

const sameFrame = { shift: 1e-3, turnDeg: 1 };

// Throws where a draft that was there before has views, or the frame of another mesh.
async function checkOld(draft: StablePose, pose: MeshStablePose): Promise<void> {
  const advice = "Delete that draft in the view Catalogue, or give the object another id";
  if ((await listViews(draft.name, 1)).length > 0) throw new Error(`${draft.name} has views already. ${advice}`);
  const apart = draft.meshPose ? between(draft.meshPose, poseOf(pose.objectMesh)) : { shift: Infinity, turn: 0 };
  if (apart.shift > sameFrame.shift || apart.turn > sameFrame.turnDeg) throw new Error(`${draft.name} is not of this mesh. ${advice}`);
}

// Removes what is left of a store that failed or was cancelled. Its errors are of no use then: an open upload ends by itself.
async function undo(upload: string, drafts: StablePose[]): Promise<void> {
  for (const attempt of [() => upload === "" ? undefined : uploads.deleteUpload({ name: upload }), () => deleteDrafts(drafts)]) {
    try {
      await attempt();
    } catch (error) {
      if (ConnectError.from(error).code !== Code.NotFound) console.warn(String(error));
    }
  }
}

// The drafts with their views. `report`: after each view. Where it fails or `signal` ends it, nothing of it stays.
export async function storeMesh(request: MeshToStore, signal: AbortSignal, report: (done: number) => void): Promise<StablePose[]> {
  const drafts: StablePose[] = [];
  const made: StablePose[] = [];
  let upload = "";
  try {
    const names = new Map<string, string>();
    for (const { pose, grasps } of request.poses) {
      signal.throwIfAborted();
      const { draft, isNew } = await makeDraft({
        objectId: request.objectId, displayName: request.displayName, stablePoseId: pose.id, symmetryOrder: pose.symmetryOrder, grasps,
        meshPose: poseOf(pose.objectMesh),
      }, drafts.length > 0);
      if (isNew) made.push(draft);
      else await checkOld(draft, pose);
      drafts.push(draft);
      names.set(pose.id, draft.name);
    }
    const uploadId = `console-${crypto.randomUUID()}`;
    upload = (await uploads.createUpload({ uploadId, upload: { expectedViewCount: BigInt(request.views.length) } }, { signal })).name;
    const regions = new Map(request.poses.map(({ pose }) => [pose.id, regionOf(transformed(request.mesh, pose.objectMesh))]));
    const sensorPose = poseOf(request.worldSensor);
    for (const [i, { poseId, image, turnDeg }] of request.views.entries()) {
      const viewId = await viewIdOf({ message: { case: "depthImage", value: image } });
      await writeUploadView({
        upload, view: {
          parent: names.get(poseId)!, viewId, regionOfInterest: regions.get(poseId)!,
          view: { depthImage: image, objectPose: poseOf(worldObjectOf(turnDeg)), sensorPose },
        },
      }, signal);
      report(i + 1);
    }
    await uploads.commitUpload({ name: upload }, { signal });
    return drafts;
  } catch (error) {
    await undo(upload, made);
    throw error;
  }
}
