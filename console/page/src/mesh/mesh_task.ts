// Long work on meshes, in a worker, so that the page answers meanwhile.
import { Matrix4 } from "three";
import type { Grasp } from "../../gen/graspdb/v1/catalog_pb";
import type { MeshFile } from "./mesh_file";
import type { MeshView } from "./mesh_views";
import type { MeshStablePose } from "./stable_poses";
import type { TriangleMesh } from "./triangle_mesh";

export type MeshTask =
  | { kind: "read"; file: File }
  | { kind: "poses"; mesh: TriangleMesh }  // in metres
  | { kind: "views"; mesh: TriangleMesh; poses: MeshStablePose[]; worldSensor: Matrix4; stepDeg: number; objectId: string };

// `mesh`: in the frame of the object.
export interface FoundPoses { poses: { pose: MeshStablePose; grasps: Grasp[]; mesh: TriangleMesh }[]; leftOut: number; isOfHull: boolean }

export interface MeshResults { read: MeshFile; poses: FoundPoses; views: MeshView[] }

// What the worker posts; `share` is below 0 where it is not known.
export type MeshMessage = { share: number; text: string } | { error: string } | { result: unknown };

// Posted objects lose their classes.
export const revived = (pose: MeshStablePose): MeshStablePose => ({ ...pose, objectMesh: new Matrix4().copy(pose.objectMesh) });

interface TrustedTypes { createPolicy(name: string, rules: { createScriptURL: (url: string) => string }): { createScriptURL: (url: string) => string } }

// The one script that the page loads by itself; its policy (CSP) allows this name alone.
function workerUrl(): string {
  const url = "/mesh_worker.js";
  const { trustedTypes } = globalThis as { trustedTypes?: TrustedTypes };
  policy ??= trustedTypes?.createPolicy("mesh-worker", { createScriptURL: () => url });
  return policy ? policy.createScriptURL(url) : url;
}
let policy: ReturnType<TrustedTypes["createPolicy"]> | undefined;

// Carries out a task. Rejects at once where `signal` is aborted, which ends the worker.
export function runMeshTask<Task extends MeshTask>(
  task: Task, signal: AbortSignal, report: (share: number, text: string) => void,
): Promise<MeshResults[Task["kind"]]> {
  return new Promise((resolve, reject) => {
    const worker = new Worker(workerUrl(), { type: "module" });
    const end = (settle: () => void): void => {
      worker.terminate();
      signal.removeEventListener("abort", abort);
      settle();
    };
    const abort = (): void => end(() => reject(signal.reason));
    signal.addEventListener("abort", abort);
    worker.addEventListener("message", ({ data }: MessageEvent<MeshMessage>) => {
      if ("text" in data) report(data.share, data.text);
      else if ("error" in data) end(() => reject(new Error(data.error)));
      else end(() => resolve(data.result as MeshResults[Task["kind"]]));
    });
    worker.addEventListener("error", (event) => end(() => reject(new Error(event.message || "the page's worker cannot be loaded; load the page again"))));
    worker.postMessage(task);
  });
}
