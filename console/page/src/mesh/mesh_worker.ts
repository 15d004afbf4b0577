// The worker of mesh_task.ts: it carries out one task.
import { Matrix4 } from "three";
import { readMesh } from "./mesh_file";
import { revived, type FoundPoses, type MeshMessage, type MeshResults, type MeshTask } from "./mesh_task";
import { renderViews } from "./mesh_views";
import { findStablePoses } from "./stable_poses";
import { proposeTopGrasps } from "./top_grasps";
import { transformed, type TriangleMesh } from "./triangle_mesh";

const post = (message: MeshMessage, transfer: ArrayBufferLike[] = []): void => postMessage(message, { transfer: transfer as ArrayBuffer[] });
const report = (share: number, text: string): void => post({ share, text });

function posesOf(mesh: TriangleMesh): FoundPoses {
  const { poses, leftOut, mass } = findStablePoses(mesh, (text) => report(-1, `Stable poses: ${text}`));
  return {
    leftOut, isOfHull: mass.isOfHull,
    poses: poses.map((pose, i) => {
      report(i / poses.length, `Grasps of ${pose.id}`);
      const posed = transformed(mesh, pose.objectMesh);
      return { pose, mesh: posed, grasps: proposeTopGrasps(posed, mass.center.clone().applyMatrix4(pose.objectMesh), pose.symmetryOrder === 0) };
    }),
  };
}

async function carryOut(task: MeshTask): Promise<MeshResults[MeshTask["kind"]]> {
  if (task.kind === "read") return readMesh(task.file.name, new Uint8Array(await task.file.arrayBuffer()));
  if (task.kind === "poses") return posesOf(task.mesh);
  const worldSensor = new Matrix4().copy(task.worldSensor);
  return renderViews(task.mesh, task.poses.map(revived), worldSensor, task.stepDeg, task.objectId, (done, all) => report(done / all, `View ${done} of ${all}`));
}

addEventListener("message", ({ data }: MessageEvent<MeshTask>) => {
  carryOut(data).then(
    (result) => post({ result }, Array.isArray(result) ? result.flatMap((view) => [view.image.data.buffer, view.points.buffer]) : []),
    (error: unknown) => post({ error: error instanceof Error ? error.message : String(error) }));
});
