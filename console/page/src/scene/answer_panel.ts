// Everything that an answer has, and why it is as it is.
import { toJsonString } from "@bufbuild/protobuf";
import { WorldFrameSource, type Detection, type StageReport } from "../../gen/graspdb/v1/recognition_pb";
import { RecognizeResponseSchema } from "../../gen/graspdb/v1/recognition_service_pb";
import type { Pose, Vector3 } from "../../gen/graspdb/v1/geometry_pb";
import type { Advice } from "../../gen/errors";
import { adviceOfGate, adviceOfStatus, gateName, isOfPoints, lostAt, objectName, statusName, taughtGrasp, tone, type Answer } from "./answer";
import { bar, facts, h, table } from "../base/dom";
import { between } from "../base/geometry";
import { count, lastPart, milliseconds, millimetres, score, shortName } from "../base/text";

const adviceText = (name: string, advice: Advice | undefined): HTMLElement | false =>
  advice !== undefined && h("div", { className: "advice" },
    h("p", {}, h("code", {}, name), `: ${advice.meaning}`),
    advice.action !== "" && h("p", {}, h("strong", {}, "Next step: "), advice.action));

const vector = (v: Vector3 | undefined): string => v ? [v.x, v.y, v.z].map((value) => value.toFixed(4)).join(", ") : "–";

const poseText = (pose: Pose | undefined): string => {
  if (!pose) return "–";
  const q = pose.orientation;
  return `${vector(pose.position)} m; ${q ? [q.x, q.y, q.z, q.w].map((value) => value.toFixed(4)).join(", ") : "–"}`;
};

function stageTable(answer: Answer): HTMLElement {
  const { stages } = answer.response;
  const lost = lostAt(stages);
  const longest = Math.max(0.001, ...stages.map((stage) => stage.durationMs));
  return h("div", {},
    lost !== undefined && h("p", { className: "lost" }, "No point is left after the stage ", h("code", {}, lost.stage), "."),
    table(["stage", "in", "out", "kept", "time"], stages.map((stage) => [
      h("code", {}, stage.stage), count(stage.inputPointCount), count(stage.outputPointCount),
      isOfPoints(stage) && stage.inputPointCount > 0 && stage.outputPointCount <= stage.inputPointCount
        ? bar(stage.outputPointCount / stage.inputPointCount, `${((100 * stage.outputPointCount) / stage.inputPointCount).toFixed(0)} %`) : "",
      h("span", { className: "time" }, bar(stage.durationMs / longest, milliseconds(stage.durationMs)), milliseconds(stage.durationMs)),
    ]), { className: "stages" }));
}

function candidateTable(detection: Detection): HTMLElement | false {
  return detection.candidates.length > 0 && h("div", {}, h("h3", {}, "Candidates: the nearest views"),
    table(["view", "distance", "verification"], detection.candidates.map((each) => [
      h("span", { title: each.view }, shortName(each.view)), each.descriptorDistance.toFixed(3),
      each.verificationScore === undefined ? "not among the best" : [bar(each.verificationScore, score(each.verificationScore)), " ", score(each.verificationScore)],
    ])));
}

function alternativeTable(detection: Detection): HTMLElement | false {
  return detection.alternatives.length > 0 && h("div", {}, h("h3", {}, "Alternatives: explain the scan as well"),
    table(["stable pose", "score", "position (m)"], detection.alternatives.map((each) => [
      shortName(each.stablePose), score(each.score), vector(each.pose?.position),
    ])));
}

function graspTable(detection: Detection): HTMLElement | false {
  return detection.grasps.length > 0 && h("div", {}, h("h3", {}, `Grasps: ${detection.grasps.length}, the best first`),
    table(["grasp", "position (m)", "opening", "approach", "priority"], detection.grasps.map((each) => {
      const grasp = taughtGrasp(each);
      return [grasp.graspId, vector(each.tcpPose?.position), millimetres(grasp.gripperOpeningM), millimetres(grasp.approachDistanceM), grasp.priority];
    })));
}

function details(detection: Detection): HTMLElement {
  const { roughPose, refinedPose, registration } = detection;
  const step = roughPose && refinedPose ? between(roughPose, refinedPose) : undefined;
  return h("div", { className: "details" },
    facts([
      ["object", detection.object || "–"], ["stable pose", lastPart(detection.stablePose) || "–"],
      ["matched view", lastPart(detection.view) || "–"], ["score", score(detection.score)],
      ["points", count(detection.pointCount)], ["centroid (m)", vector(detection.centroid)],
      ["refined pose", poseText(refinedPose)], ["rough pose", poseText(roughPose)],
      ["rough to refined", step ? `${millimetres(step.shift)}, ${step.turn.toFixed(1)}°` : "–"],
      ["pose of the mesh", poseText(detection.meshPose)],
      ["alignment", registration
        ? `${registration.converged ? "converged" : "not converged"} after ${registration.iterationCount}, rms ${millimetres(registration.rmsErrorM)}, ${(100 * registration.inlierFraction).toFixed(0)} % of the view`
        : "nothing was aligned"],
      ["equivalent poses", String(detection.equivalentPoses.length)],
      ["touching a neighbour", detection.touching ? "yes" : "no"],
    ]),
    graspTable(detection), candidateTable(detection), alternativeTable(detection));
}

// What an unknown object resembles most: the candidate that was verified best.
function closest(detection: Detection): HTMLElement | false {
  const verified = detection.candidates.filter((each) => each.verificationScore !== undefined);
  if (detection.object !== "" || verified.length === 0) return false;
  const best = verified.reduce((a, b) => (b.verificationScore! > a.verificationScore! ? b : a));
  const [, object, , stablePose] = best.view.split("/");
  return h("p", { className: "closest" }, "Closest: ", h("strong", {}, object), `, ${stablePose}. `,
    `Its aligned model and the scan agree to ${(100 * best.verificationScore!).toFixed(0)} %.`);
}

function detectionCard(detection: Detection, isSelected: boolean, select: () => void): HTMLElement {
  const advice = adviceOfStatus(detection.status);
  const gate = adviceOfGate(detection);
  return h("section", { className: `detection ${tone(detection)}${isSelected ? " selected" : ""}` },
    h("button", { type: "button", className: "head", "aria-expanded": isSelected, onclick: select },
      h("span", { className: "name" }, objectName(detection)), h("span", { className: "status" }, statusName(detection.status)),
      bar(detection.score, `score ${score(detection.score)}`), h("span", { className: "number" }, score(detection.score))),
    closest(detection),
    adviceText(statusName(detection.status), advice),
    gate !== undefined && adviceText(gateName(detection), gate),
    isSelected && details(detection));
}

export function answerPanel(answer: Answer, selected: number, select: (index: number) => void): HTMLElement {
  const { response } = answer;
  const wholeAdvice = response.detections.some((each) => each.status === response.status) ? undefined : adviceOfStatus(response.status);
  return h("div", { className: "answer" },
    h("p", { className: "headline" },
      h("strong", { className: `status-of ${statusName(response.status) === "OK" ? "ok" : "bad"}` }, statusName(response.status)),
      ` · ${response.detections.length} detection${response.detections.length === 1 ? "" : "s"} · ${milliseconds(response.timings?.totalMs ?? 0)} on the server, ${milliseconds(answer.elapsedMs)} with the way · revision ${response.catalogRevision}`),
    adviceText(statusName(response.status), wholeAdvice),
    response.untriedViewCount > 0 && h("p", {}, `${response.untriedViewCount} views were not tried, since the frame's budget was spent.`),
    response.searchTimedOut && h("p", {}, "The search ended early, since it had taken 2 s."),
    response.detections.map((each, i) => detectionCard(each, i === selected, () => select(i === selected ? -1 : i))),
    h("h2", {}, "Points after each stage"), stageTable(answer),
    h("details", {}, h("summary", {}, "Frame and times"), facts([
      ["world frame from", WorldFrameSource[response.worldFrameSource]?.toLowerCase().replace(/_/g, " ") ?? "–"],
      ["sensor pose", poseText(response.sensorPose)],
      ["decode", milliseconds(response.timings?.decodeMs ?? 0)], ["segment", milliseconds(response.timings?.segmentMs ?? 0)],
      ["describe", milliseconds(response.timings?.describeMs ?? 0)], ["match", milliseconds(response.timings?.matchMs ?? 0)],
      ["register", milliseconds(response.timings?.registerMs ?? 0)], ["parameters", answer.parameters.summary],
    ])),
    h("details", {}, h("summary", {}, "As JSON"),
      h("pre", { tabIndex: 0 }, toJsonString(RecognizeResponseSchema, response, { prettySpaces: 2 }))));
}

// The detection of `others` at the same place, within a part's size.
function partner(detection: Detection, others: Detection[]): Detection | undefined {
  const maxDistance = 0.05;
  const distance = (other: Detection): number => Math.hypot(
    (detection.centroid?.x ?? 0) - (other.centroid?.x ?? 0), (detection.centroid?.y ?? 0) - (other.centroid?.y ?? 0),
    (detection.centroid?.z ?? 0) - (other.centroid?.z ?? 0));
  const nearest = others.reduce<Detection | undefined>((best, other) => !best || distance(other) < distance(best) ? other : best, undefined);
  return nearest && distance(nearest) <= maxDistance ? nearest : undefined;
}

const brief = (detection: Detection | undefined): string =>
  detection ? `${objectName(detection)}, ${statusName(detection.status)}, ${score(detection.score)}` : "none";

// Two answers, row by row.
export function comparison(a: Answer, b: Answer): HTMLElement {
  const [left, right] = [a.response, b.response];
  const rows: [string, string, string, boolean][] = [];
  const add = (name: string, one: string, two: string, differs = one !== two): void => void rows.push([name, one, two, differs]);
  add("parameters", a.parameters.summary, b.parameters.summary);
  add("scan", a.scan.name, b.scan.name);
  add("status", statusName(left.status), statusName(right.status));
  add("detections", String(left.detections.length), String(right.detections.length));
  add("revision", String(left.catalogRevision), String(right.catalogRevision));
  add("time", milliseconds(left.timings?.totalMs ?? 0), milliseconds(right.timings?.totalMs ?? 0), false);
  const matched = new Set<Detection>();
  for (const each of left.detections) {
    const other = partner(each, right.detections);
    if (other) matched.add(other);
    const step = each.refinedPose && other?.refinedPose ? between(each.refinedPose, other.refinedPose) : undefined;
    add(`at ${vector(each.centroid)}`, brief(each),
      brief(other) + (step ? `; pose differs by ${millimetres(step.shift)}, ${step.turn.toFixed(1)}°` : ""), brief(each) !== brief(other));
  }
  for (const other of right.detections) if (!matched.has(other)) add(`at ${vector(other.centroid)}`, "none", brief(other));
  const stages = [...new Set([...left.stages, ...right.stages].map((stage) => stage.stage))];
  for (const name of stages) {
    const [one, two] = [a, b].map((answer) => answer.response.stages.find((each) => each.stage === name));
    const counts = (stage: StageReport | undefined): string => stage ? `${count(stage.inputPointCount)} → ${count(stage.outputPointCount)}` : "–";
    const text = (stage: StageReport | undefined): string => stage ? `${counts(stage)}, ${milliseconds(stage.durationMs)}` : "–";
    add(name, text(one), text(two), counts(one) !== counts(two));
  }
  return h("div", { className: "comparison" }, h("h2", {}, `Answers ${a.number} and ${b.number}`),
    table(["of", `answer ${a.number}`, `answer ${b.number}`], rows.map(([name, one, two, differs]) =>
      [name, one, h("span", { className: differs ? "differs" : "" }, two)])));
}
