// One answer of the server to a scan.
import { RecognitionStatus, RejectionGateSchema, type Detection, type GraspProposal, type StageReport } from "../../gen/graspdb/v1/recognition_pb";
import type { Grasp } from "../../gen/graspdb/v1/catalog_pb";
import type { RecognizeResponse } from "../../gen/graspdb/v1/recognition_service_pb";
import { gates, statuses, type Advice } from "../../gen/errors";
import type { Parameters } from "./parameters";
import type { Scan } from "../files/scan";
import { lastPart } from "../base/text";

export interface Answer {
  number: number;
  scan: Scan;
  parameters: Parameters;
  response: RecognizeResponse;
  elapsedMs: number;  // with the way to the server and back
}

export const statusName = (status: RecognitionStatus): string => RecognitionStatus[status] ?? String(status);

export const gateName = (detection: Detection): string => RejectionGateSchema.value[detection.rejectedBy]?.name ?? "";

export const objectName = (detection: Detection): string =>
  detection.object === "" ? "unknown object" : lastPart(detection.object);

// Servers of before the field `grasp` send the deprecated fields only, of the same names.
export const taughtGrasp = (proposal: GraspProposal): Grasp | GraspProposal => proposal.grasp ?? proposal;

// "ok", "warning" or "bad": the colour of a detection.
export function tone(detection: Detection): string {
  if (detection.status === RecognitionStatus.OK) return "ok";
  return detection.object === "" ? "bad" : "warning";
}

export function adviceOfStatus(status: RecognitionStatus): Advice | undefined {
  return status === RecognitionStatus.OK ? undefined : statuses[statusName(status)];
}

export const adviceOfGate = (detection: Detection): Advice | undefined => gates[gateName(detection)];

// The stage after which no points were left.
export const lostAt = (stages: StageReport[]): StageReport | undefined =>
  stages.find((stage) => stage.inputPointCount > 0 && stage.outputPointCount === 0 && isOfPoints(stage));

// Those of the search in the image count proposals and answers.
export const isOfPoints = (stage: StageReport): boolean =>
  !["frame", "verify", "propose", "confirm", "explain", "match", "register", "descriptor"].includes(stage.stage);
