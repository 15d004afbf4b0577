// Stable poses that recognition may confuse, and minimum scores proposed from the taught views.
import { Code, ConnectError } from "@connectrpc/connect";
import { Matrix4 } from "three";
import type { StablePose } from "../../gen/graspdb/v1/catalog_pb";
import type { LookAlikePair, StablePoseSymmetry } from "../../gen/graspdb/v1/look_alikes_pb";
import type { FindLookAlikesResponse } from "../../gen/graspdb/v1/recognition_service_pb";
import type { ThresholdProposal } from "../../gen/graspdb/v1/thresholds_pb";
import { catalog, listObjects, listViews, recognition, type Explained } from "../base/api";
import { attempt } from "../base/attempt";
import { h, replace } from "../base/dom";
import { matrixOf, moved, type Points } from "../base/geometry";
import { boxOf, pointsInObjectFrame, viewsToDraw } from "./stable_pose_points";
import { lastPart, millimetres, score, shortName } from "../base/text";
import { axesObject, cloudObject, emptyPane, styleColor, Viewer } from "../base/viewer";

const maxViews = 500;
const otherColor = "#f08a24";

type Found = { kind: "pair"; value: LookAlikePair } | { kind: "symmetry"; value: StablePoseSymmetry };

const turns = (order: number): string => order === 0 ? "any turn" : order === 2 ? "half a turn" : `1/${order} of a turn`;

// The same words as of `graspdb objects check`.
function textOf(found: Found): { what: string; advice: string } {
  const { value } = found;
  const apart = value.gap ? `${millimetres(value.gap.meanM)} apart on average` : "";
  const ambiguous = value.nearly ? "Detections may be AMBIGUOUS." : "Detections will be AMBIGUOUS.";
  if (found.kind === "pair") return { what: `look ${value.nearly ? "nearly " : ""}alike, ${apart}`, advice: ambiguous };
  const { declaredOrder, foundOrder, nearly } = found.value;
  if (foundOrder === declaredOrder) return { what: `looks the same after ${turns(foundOrder)}, as declared`, advice: "" };
  if (foundOrder === 1) {
    return { what: `is declared to look the same after ${turns(declaredOrder)}, but its views differ`, advice: "Correct the symmetry, or the poses of the views." };
  }
  return {
    what: `looks ${nearly ? "nearly " : ""}the same after ${turns(foundOrder)}, ${apart}`,
    advice: nearly ? ambiguous : `If these orientations are equivalent for the robot, declare the symmetry ${foundOrder}.`,
  };
}

export class LookAlikeView {
  readonly element: HTMLElement;
  private readonly viewer = new Viewer("Two stable poses, put together", () => {});
  private readonly object = h("select", { id: "look-alikes-of" });
  private readonly findButton = h("button", { type: "button", className: "primary", onclick: () => void this.find() }, "Find look-alikes");
  private readonly list = h("div", { className: "answers" });
  private readonly title = h("div", { className: "poses" });
  private readonly proposeButton = h("button", { type: "button", className: "primary", onclick: () => void this.propose() }, "Propose minimum scores");
  private readonly stopButton = h("button", { type: "button", hidden: true, onclick: () => this.stop?.abort() }, "Stop");
  private readonly progress = h("p", { role: "status" });
  private readonly table = h("div", {});
  private found: Found[] = [];
  private shown: Found | undefined;
  private proposals: { proposal: ThresholdProposal; pose: StablePose; box: HTMLInputElement }[] = [];
  private stop: AbortController | undefined;
  private drawing = 0;

  constructor(private readonly report: (error: Explained | undefined) => void) {
    this.element = h("div", { className: "scene look-alikes" },
      h("aside", { "aria-label": "Look-alikes" },
        h("div", { className: "field" }, h("label", { for: "look-alikes-of" }, "object"), this.object), this.findButton, this.list),
      h("div", { className: "stage" }, this.title, this.viewer.element),
      h("aside", { className: "right", "aria-label": "Minimum scores" }, h("h2", {}, "Minimum scores"),
        h("p", { className: "hint" }, "Some views of each stable pose are recognised with themselves left out, and with their object left out. ",
          "It takes seconds for each object, and changes nothing before it is applied."),
        this.proposeButton, this.stopButton, this.progress, this.table));
  }

  opened(): void {
    this.viewer.draw();
    void this.attempt(async () => {
      const before = this.object.value;
      const objects = await listObjects(2000);
      replace(this.object, h("option", { value: "" }, "all"), objects.map((each) => h("option", { value: each.name }, each.displayName || lastPart(each.name))));
      this.object.value = objects.some((each) => each.name === before) ? before : "";
    });
  }

  recolour(): void {
    void this.attempt(() => this.draw(false));
  }

  private attempt(action: () => Promise<void>): Promise<void> {
    return attempt(this.report, action);
  }

  private async find(): Promise<void> {
    this.findButton.disabled = true;
    await this.attempt(async () => {
      this.report(undefined);
      const response: FindLookAlikesResponse = await recognition.findLookAlikes({ object: this.object.value });
      this.found = [
        ...response.pairs.map((value): Found => ({ kind: "pair", value })),
        ...response.symmetries.map((value): Found => ({ kind: "symmetry", value })),
      ];
      this.shown = this.found[0];
      this.updateList();
      if (this.found.length === 0) replace(this.list, h("p", { className: "hint" }, "No stable poses look alike, and none looks the same when turned."));
      await this.draw(true);
    });
    this.findButton.disabled = false;
  }

  private updateList(): void {
    replace(this.list, this.found.map((each) => {
      const { what, advice } = textOf(each);
      const { value } = each;
      return h("div", {},
        h("button", {
          type: "button", className: "pick", "aria-pressed": each === this.shown,
          onclick: () => {
            this.shown = each;
            this.updateList();
            void this.attempt(() => this.draw(true));
          },
        }, h("strong", {}, shortName(value.stablePose)), each.kind === "pair" && [" and ", h("strong", {}, shortName(each.value.other))],
        h("small", {}, what), advice !== "" && h("small", {}, advice)),
        each.kind === "symmetry" && !value.nearly && each.value.foundOrder !== each.value.declaredOrder && each.value.foundOrder !== 1 &&
          h("button", { type: "button", className: "beside", onclick: () => void this.declare(each.value) }, `Declare the symmetry ${each.value.foundOrder}`));
    }));
  }

  private declare(symmetry: StablePoseSymmetry): Promise<void> {
    return this.attempt(async () => {
      await catalog.updateStablePose({
        stablePose: { name: symmetry.stablePose, symmetryOrder: symmetry.foundOrder }, updateMask: { paths: ["symmetry_order"] },
      });
      await this.find();
    });
  }

  private async pointsOf(stablePose: string): Promise<Points[]> {
    return Promise.all(viewsToDraw(await listViews(stablePose, maxViews)).map((each) => pointsInObjectFrame(each.name)));
  }

  private async draw(look: boolean): Promise<void> {
    const drawing = ++this.drawing;
    const { shown } = this;
    const pane = emptyPane();
    replace(this.title);
    if (shown) {
      // A symmetric one beside itself, turned.
      const turn = shown.kind === "symmetry" ? new Matrix4().makeRotationZ((2 * Math.PI) / Math.max(2, shown.value.foundOrder || 5)) : matrixOf(shown.value.pose);
      const [own, others] = await Promise.all([this.pointsOf(shown.value.stablePose), shown.kind === "pair" ? this.pointsOf(shown.value.other) : undefined]);
      if (drawing !== this.drawing) return;
      const placed = own.map((points) => moved(points, turn));
      for (const points of placed) pane.content.add(cloudObject(points, styleColor("--low"), 2));
      for (const points of others ?? own) pane.content.add(cloudObject(points, otherColor, 2));
      pane.content.add(axesObject(new Matrix4(), 0.03));
      replace(this.title, h("span", { className: "chip key-low" }, shortName(shown.value.stablePose), shown.kind === "symmetry" && ", turned"),
        h("span", { className: "chip key-other" }, shortName(shown.kind === "pair" ? shown.value.other : shown.value.stablePose)));
      this.viewer.show([pane]);
      if (look) this.viewer.look(boxOf([...placed, ...(others ?? own)]));
      return;
    }
    this.viewer.show([pane]);
  }

  private async propose(): Promise<void> {
    this.proposeButton.disabled = true;
    this.stopButton.hidden = false;
    this.stop = new AbortController();
    replace(this.table);
    await this.attempt(async () => {
      this.report(undefined);
      try {
        let proposals: ThresholdProposal[] = [];
        for await (const each of recognition.proposeThresholds({ object: this.object.value }, { signal: this.stop!.signal, timeoutMs: 0 })) {
          replace(this.progress, h("meter", { min: 0, max: Math.max(1, each.viewCount), value: each.doneViewCount, "aria-label": "views" }), ` ${each.doneViewCount} of ${each.viewCount} views`);
          proposals = each.proposals;
        }
        await this.showProposals(proposals);
        replace(this.progress, proposals.length === 0 ? "There are no views to evaluate." : "Nothing is changed yet.");
      } catch (error) {
        if (ConnectError.from(error).code !== Code.Canceled) throw error;
        replace(this.progress, "Stopped. Nothing is changed.");
      }
    });
    this.stop = undefined;
    this.proposeButton.disabled = false;
    this.stopButton.hidden = true;
  }

  private async showProposals(proposals: ThresholdProposal[]): Promise<void> {
    this.proposals = await Promise.all(proposals.map(async (proposal) => {
      const pose = await catalog.getStablePose({ name: proposal.stablePose });
      const differs = proposal.minScore !== pose.minScore;
      return { proposal, pose, box: h("input", { type: "checkbox", checked: differs, disabled: !differs }) };
    }));
    const value = (minScore: number | undefined): string => minScore === undefined ? "the cell's" : score(minScore);
    replace(this.table, this.proposals.map(({ proposal, pose, box }) => h("div", { className: "detection" },
      h("label", { className: "head" }, box, h("span", { className: "name" }, shortName(pose.name)),
        box.disabled ? `${value(pose.minScore)}, as now` : `${value(pose.minScore)} → ${value(proposal.minScore)}`),
      h("p", { className: "hint" }, `${proposal.rightViewCount} of ${proposal.askedViewCount} views named`,
        proposal.rightScore !== undefined && `, most with ${score(proposal.rightScore)} or more`,
        proposal.wrongScore !== undefined && `; ${shortName(proposal.wrongView)} was taken for it with ${score(proposal.wrongScore)}`, "."))),
    this.proposals.some((each) => !each.box.disabled) && h("button", { type: "button", className: "primary", onclick: () => void this.apply() }, "Apply the chosen ones"));
  }

  private apply(): Promise<void> {
    return this.attempt(async () => {
      this.report(undefined);
      const chosen = this.proposals.filter((each) => each.box.checked);
      let done = 0;
      try {
        for (const { proposal, pose } of chosen) {
          await catalog.updateStablePose({
            stablePose: { name: pose.name, etag: pose.etag, minScore: proposal.minScore }, updateMask: { paths: ["min_score"] },
          });
          ++done;
        }
      } finally {
        await this.showProposals(this.proposals.map((each) => each.proposal));
        replace(this.progress, `${done} of ${chosen.length} applied.`);
      }
    });
  }
}
