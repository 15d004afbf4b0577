// The view of the server's state, and of how long its answers to this page took.
import type { CacheStatus, CatalogStatus } from "../gen/graspdb/v1/catalog_service_pb";
import type { DiskSpace } from "../gen/graspdb/v1/server_state_pb";
import { catalog, explain, type Explained } from "./base/api";
import type { Answer } from "./scene/answer";
import { bar, facts, h, replace, table } from "./base/dom";
import { bytes, count, duration, milliseconds } from "./base/text";

const renewMs = 5000;

function median(values: number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)] ?? 0;
}

const cache = (status: CacheStatus | undefined): string => {
  if (!status) return "–";
  const uses = Number(status.hitCount + status.missCount);
  return `${bytes(status.byteCount)} of ${bytes(status.byteBudget)}` + (uses > 0 ? `, ${((100 * Number(status.hitCount)) / uses).toFixed(0)} % hits` : "");
};

const disk = (space: DiskSpace | undefined): string => space ? `${bytes(space.availableByteCount)} of ${bytes(space.byteCount)} free` : "–";

export class HealthView {
  readonly element: HTMLElement;
  private readonly state = h("div", { className: "cards", "aria-live": "off" });
  private readonly times = h("div", { className: "card wide" });
  private readonly answers: Answer[] = [];

  constructor(private readonly report: (error: Explained | undefined) => void) {
    this.element = h("div", { className: "health" }, this.state, this.times);
    setInterval(() => {
      if (this.element.isConnected && !document.hidden) void this.renew();
    }, renewMs);
    this.updateTimes();
  }

  opened(): void {
    void this.renew();
    this.updateTimes();
  }

  add(answer: Answer): void {
    this.answers.push(answer);
    if (this.answers.length > 200) this.answers.shift();
  }

  private async renew(): Promise<void> {
    try {
      this.show(await catalog.getCatalogStatus({}));
      this.report(undefined);
    } catch (error) {
      this.report(explain(error));
    }
  }

  private show(status: CatalogStatus): void {
    const state = status.serverState;
    const picks = Number(status.pickedCount + status.missedCount + status.slippedCount);
    const card = (title: string, rows: [string, string | number][]): HTMLElement =>
      h("section", { className: "card" }, h("h2", {}, title), facts(rows.map(([name, value]) => [name, String(value)])));
    const faults = [
      ...(state?.writeFault ? [state.writeFault.error] : []), ...(state?.fileFaults ?? []).map((fault) => `${fault.flag}: ${fault.error}`),
      ...(state?.damagedFiles ?? []).map((file) => `${file.name}: ${file.error}`),
      ...(status.backup?.lastError ? [`backup: ${status.backup.lastError}`] : []),
      ...(Number(status.leftOutRecordCount) > 0 ? [`${status.leftOutRecordCount} records cannot be used; the server's log names them`] : []),
    ];
    replace(this.state,
      h("section", { className: `card ${faults.length > 0 || state?.serving === false ? "bad" : "ok"}` }, h("h2", {}, "State"),
        h("p", { className: "big" }, state?.serving === false ? "not all changes are in the index" : faults.length > 0 ? "faults" : "serving"),
        faults.map((fault) => h("p", {}, fault))),
      card("Catalogue", [
        ["revision", count(status.catalogRevision)], ["in the index", count(state?.indexRevision ?? 0n)], ["objects", count(status.objectCount)],
        ["stable poses", count(status.stablePoseCount)], ["views", count(status.viewCount)], ["id", status.catalogId],
      ]),
      card("Server", [
        ["version", status.serverVersion], ["running for", duration(status.uptimeS)], ["descriptor", status.descriptorName],
        ["schema", status.schemaVersion],
      ]),
      card("Memory", [
        ["resident", bytes(status.memory?.residentByteCount ?? 0n)], ["limit", bytes(status.memory?.byteBudget ?? 0n)],
        ["requests refused", count(status.memory?.refusedRequestCount ?? 0n)], ["models", cache(status.modelCache)], ["clouds", cache(status.cloudCache)],
      ]),
      card("Disk", [["database", bytes(state?.databaseByteCount ?? 0n)], ["its disk", disk(state?.databaseDisk)]]),
      card("Backups", status.backup
        ? [["without damage", status.backup.backupCount], ["age of the last", status.backup.lastGoodBackup ? duration(status.backup.lastGoodAgeS) : "–"], ["disk", disk(status.backup.disk)]]
        : [["folder", "none: --backup-dir"]]),
      card("Picks", [
        ["reported", count(picks)], ["picked", count(status.pickedCount)], ["missed", count(status.missedCount)], ["slipped", count(status.slippedCount)],
        ["success", picks > 0 ? `${((100 * Number(status.pickedCount)) / picks).toFixed(1)} %` : "–"],
      ]));
  }

  private updateTimes(): void {
    const names = [...new Set(this.answers.flatMap((answer) => answer.response.stages.map((stage) => stage.stage)))];
    const of = (name: string): number[] =>
      this.answers.flatMap((answer) => answer.response.stages.filter((stage) => stage.stage === name).map((stage) => stage.durationMs));
    const total = this.answers.map((answer) => answer.response.timings?.totalMs ?? 0);
    const longest = Math.max(0.001, ...names.map((name) => median(of(name))));
    replace(this.times, h("h2", {}, "Stage times of this page's answers"),
      this.answers.length === 0 ? h("p", { className: "hint" }, "None yet: recognise a scan.") : [
        h("p", {}, `${this.answers.length} answer${this.answers.length === 1 ? "" : "s"}, median ${milliseconds(median(total))}, longest ${milliseconds(Math.max(...total))}.`),
        table(["stage", "median", "share", "longest"], names.map((name) => [
          h("code", {}, name), milliseconds(median(of(name))), bar(median(of(name)) / longest, milliseconds(median(of(name)))), milliseconds(Math.max(...of(name))),
        ])),
      ]);
  }
}
