// Cells, frames of their black box, and parameters that are saved to a cell.
import { strict as assert } from "node:assert";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { until } from "./page.mjs";
import { bundleBytes, pageModule } from "./programs.mjs";

const kName = "cells/press-3";

// A frame of the scene as a bundle, with parameters and the server's answer.
async function recorded({ work, folder, call }, scene) {
  const { readPcd } = await pageModule(work, "files/point_file", folder);
  const { cloud } = readPcd(readFileSync(scene));
  const fields = ["x", "y", "z"].map((name, i) => ({ name, offset: 4 * i, type: "NUMERIC_TYPE_FLOAT32" }));
  const request = {
    cell: kName, omitTimings: true, pipeline: { minScore: 0.9999 },
    cloud: { pointStride: 12, width: cloud.width, fields, data: Buffer.from(cloud.data).toString("base64") },
  };
  const response = await call("RecognitionService/Recognize", request);
  const path = join(folder, "9999999999-with-parameters.bundle");
  writeFileSync(path, await bundleBytes(work, folder, { requestTime: new Date().toISOString(), durationMs: 40, robot: "robot-1", request, response, catalogRevision: response.catalogRevision }));
  return path;
}

export async function testCells(test) {
  const { page, folder, sceneOf, bundles, sensorPose, step, picture, checkRules, call, refused } = test;
  const cell = () => call("CellService/GetCell", { name: kName });
  const save = page.getByRole("button", { name: "Save the cell" });
  const numbers = (id) => Promise.all([0, 1, 2, 3, 4, 5].map(async (i) => Number(await page.locator(`#${id}-${i}`).inputValue())));

  step("a new cell: its region and camera, typed");
  await page.getByRole("link", { name: "Cells" }).click();
  await page.locator('#cell-name option[value="cells/demo"]').waitFor({ state: "attached" });
  await page.getByText("New cell").click();
  await page.locator("#cell-new").fill("press-3");
  await page.getByRole("button", { name: "Create" }).click();
  await page.locator('#cell-name option[value="cells/press-3"]').waitFor({ state: "attached" });
  await page.locator("#cell-region").check();
  assert.deepEqual(await numbers("cell-region"), [-300, -300, -20, 300, 300, 400]);
  await page.locator("#cell-region-0").fill("-250");
  await page.locator("#cell-workspace").check();
  await page.locator("#cell-camera").check();
  await page.locator("#cell-labels").fill("line-1, line-2");
  await save.click();
  await page.getByText("Saved. The cell's agent uses it within seconds.").waitFor();
  const typed = await cell();
  assert.deepEqual(typed.regionOfInterest.min, { x: -0.25, y: -0.3, z: -0.02 });
  assert.deepEqual(typed.labels, ["line-1", "line-2"]);
  assert.equal(typed.sensorPose.position.z, 0.8);
  assert.equal(typed.robotBasePose, undefined);

  step("dragged: the region moves, the workspace gets another size");
  const drawn = await until(page, "boxes and handle are drawn", (now) => now.handle.count > 20);
  const canvas = await page.locator(".cells .viewer canvas").boundingBox();
  const drag = async ({ x, y }) => {
    await page.mouse.move(canvas.x + x, canvas.y + y);
    await page.mouse.down();
    for (let i = 1; i <= 4; ++i) await page.mouse.move(canvas.x + x + 12 * i, canvas.y + y + 6 * i);
    await page.mouse.up();
  };
  const tools = page.getByRole("group", { name: "What to drag" });
  const before = await numbers("cell-region");
  await drag(drawn.handle);
  const after = await numbers("cell-region");
  assert.ok(after.some((value, i) => Math.abs(value - before[i]) > 5), `${before} ${after}`);
  [0, 1, 2].forEach((i) => assert.ok(Math.abs(after[i + 3] - after[i] - (before[i + 3] - before[i])) < 0.1, "its size is the same"));
  await tools.getByRole("button", { name: "workspace" }).click();
  await tools.getByRole("button", { name: "Size" }).click();
  const sizes = await until(page, "the handle is drawn", (now) => now.handle.count > 20);
  const was = await numbers("cell-workspace");
  await drag(sizes.handle);
  const is = await numbers("cell-workspace");
  assert.ok(is.some((value, i) => Math.abs(value - was[i]) > 5), `${was} ${is}`);
  await page.getByRole("button", { name: "Discard the changes" }).click();
  assert.deepEqual(await numbers("cell-region"), before);

  step("a conflict has its next step");
  await page.locator("#cell-base").check();
  await call("CellService/UpdateCell", { cell: { name: kName, sensorPose, displayName: "Press 3", labels: [] }, updateMask: "sensorPose,displayName,labels" });
  await save.click();
  await page.locator(".cells .conflict").getByText("Next step").waitFor();
  assert.equal((await cell()).robotBasePose, undefined, "nothing was written");
  await page.getByRole("button", { name: "Take theirs" }).click();
  const isTheirs = async () => {
    assert.equal(await page.locator("#cell-base").isChecked(), false);
    assert.equal(await page.locator("#cell-labels").inputValue(), "");
    assert.ok(Math.abs((await numbers("cell-camera"))[1] - 1000 * sensorPose.position.y) < 0.01);
  };
  await isTheirs();
  refused.push(409);

  step("frames of the black box, the newest first");
  const ofDemo = [bundles.at(0), bundles.at(-1)];
  await page.setInputFiles("#cell-files", [await recorded(test, sceneOf("l-bracket")), ...ofDemo]);
  const rows = page.locator(".cells .answers .pick");
  await rows.nth(2).waitFor();
  const texts = await rows.allInnerTexts();
  assert.match(texts[0], /^\S+ \S+ · UNKNOWN_OBJECT\s*press-3, robot-1/);
  for (const text of texts.slice(1)) assert.match(text, /^\S+ \S+ · OK\s*demo, /);
  const times = texts.map((text) => text.slice(0, 19));
  assert.deepEqual([...times].sort().reverse(), times);
  await until(page, "the frame is drawn", (now) => now.all > 100);
  await isTheirs();
  await tools.getByRole("button", { name: "region" }).click();
  await picture("cells");
  await checkRules("cells");

  step("a recorded answer in the scene, and parameters that are saved to its cell");
  await page.locator(".cells .answers .beside").first().click();
  await page.locator(".answer .headline").getByText("UNKNOWN_OBJECT").waitFor();
  assert.equal(await page.locator("#minScore").inputValue(), "0.9999");
  await page.locator('#cell option[value="cells/press-3"]').waitFor({ state: "attached" });
  await page.waitForFunction(() => globalThis.document.querySelector("#cell").value === "cells/press-3");
  await page.locator("#minScore").fill("0.6");
  await page.getByRole("button", { name: "Recognise" }).click();
  await page.locator(".headline").getByText(/^OK/).waitFor();
  await page.getByRole("button", { name: "Save them to the cell" }).click();
  await page.getByText("Saved: press-3 uses them for all of its frames.").waitFor();
  assert.deepEqual((await cell()).pipeline, { minScore: 0.6 });
  assert.deepEqual((await cell()).regionOfInterest.min, { x: -0.25, y: -0.3, z: -0.02 }, "the others stay");
  await page.locator("#minScore").fill("");
  await page.getByRole("button", { name: "Save them to the cell" }).click();
  await page.locator(".banner").getByText("give a parameter first").waitFor();
  const cut = join(folder, "cut.bundle");
  writeFileSync(cut, readFileSync(ofDemo[0]).subarray(0, 5000));
  await page.setInputFiles("#files", cut);
  await page.locator(".banner").getByText("cut.bundle: it is truncated or damaged").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
}
