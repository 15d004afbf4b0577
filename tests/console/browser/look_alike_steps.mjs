// Look-alikes, and minimum scores.
import { strict as assert } from "node:assert";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { until } from "./page.mjs";

export async function testLookAlikes({ page, folder, step, picture, checkRules, call, graspdb }) {
  step("pairs and symmetries, as of the server");
  const pose = (await call("CatalogService/ListStablePoses", { parent: "objects/flange" })).stablePoses[0];
  await call("CatalogService/UpdateStablePose", { stablePose: { name: pose.name, symmetryOrder: 1 }, updateMask: "symmetryOrder" });
  // The same part under two names.
  const set = join(folder, "twin");
  graspdb("simulate", "--parts", "l-bracket", "--step", "60", "--seed", "5", "--out", set);
  const file = join(set, "captures.json");
  writeFileSync(file, readFileSync(file, "utf8").replaceAll('"l-bracket"', '"twin"'));
  graspdb("import", set);
  const found = await call("RecognitionService/FindLookAlikes", {});
  assert.equal(found.pairs.some((each) => each.stablePose.startsWith("objects/l-bracket/") && each.other.startsWith("objects/twin/")), true, JSON.stringify(found));
  assert.ok(found.symmetries.length > 0);
  await page.getByRole("link", { name: "Look-alikes" }).click();
  const find = page.getByRole("button", { name: "Find look-alikes" });
  await find.click();
  const rows = page.locator(".look-alikes .pick");
  await rows.nth(found.pairs.length + found.symmetries.length - 1).waitFor();
  const first = await rows.first().innerText();
  for (const name of [found.pairs[0].stablePose, found.pairs[0].other]) assert.ok(first.includes(name.split("/")[1]), first);
  assert.ok(first.includes(`${(found.pairs[0].gap.meanM * 1000).toFixed(1)} mm apart`), first);
  await until(page, "both are drawn", (now) => now.grasps.count > 100 && now.all > 20);

  step("a symmetry is declared");
  const declare = page.getByRole("button", { name: "Declare the symmetry 4", exact: true });
  await declare.click();
  await declare.waitFor({ state: "detached" });
  assert.equal((await call("CatalogService/GetStablePose", { name: pose.name })).symmetryOrder, 4);
  await page.getByText("looks the same after 1/4 of a turn, as declared").waitFor();

  step("proposals that are stopped change nothing");
  await page.route("**/ProposeThresholds", () => {});  // no response
  await page.getByRole("button", { name: "Propose minimum scores" }).click();
  await page.getByRole("button", { name: "Stop" }).click();
  await page.getByText("Stopped. Nothing is changed.").waitFor();
  await page.unroute("**/ProposeThresholds");

  step("minimum scores are proposed, and applied where chosen");
  await page.locator("#look-alikes-of").selectOption("objects/flange");
  await call("CatalogService/UpdateStablePose", { stablePose: { name: pose.name, minScore: 0.11 }, updateMask: "minScore" });
  await page.getByRole("button", { name: "Propose minimum scores" }).click();
  await page.getByText("Nothing is changed yet.").waitFor();
  const proposal = page.locator(".look-alikes .detection");
  assert.equal(await proposal.count(), 1);
  assert.match(await proposal.innerText(), /0\.11 → .*\n*.* of 8 views named/);
  await page.locator("#look-alikes-of").selectOption("");
  await page.locator(".look-alikes .pick").first().click();
  await until(page, "both are drawn", (now) => now.grasps.count > 100);
  await picture("look-alikes");
  await checkRules("look-alikes");
  assert.equal((await call("CatalogService/GetStablePose", { name: pose.name })).minScore, 0.11);
  await page.getByRole("button", { name: "Apply the chosen ones" }).click();
  await page.getByText("1 of 1 applied.").waitFor();
  const applied = (await call("CatalogService/GetStablePose", { name: pose.name })).minScore;
  const expected = JSON.parse(graspdb("objects", "thresholds", "flange", "--json")).proposals[0].minScore;
  assert.equal(applied, expected);
}
