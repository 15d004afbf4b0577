// Teaching from a mesh.
import { strict as assert } from "node:assert";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { until } from "./page.mjs";

// The turn of T_world_object about z, degrees.
const turnOf = ({ orientation: { z = 0, w = 0 } }) => Math.round((((2 * Math.atan2(z, w) * 180) / Math.PI) + 360) % 360);
const length = ({ x = 0, y = 0, z = 0 }) => Math.hypot(x, y, z);
const minus = (a, b) => ({ x: (a.x ?? 0) - (b.x ?? 0), y: (a.y ?? 0) - (b.y ?? 0), z: (a.z ?? 0) - (b.z ?? 0) });
const angle = (a, b) => (2 * Math.acos(Math.min(1, Math.abs(["x", "y", "z", "w"].reduce((sum, k) => sum + (a[k] ?? 0) * (b[k] ?? 0), 0)))) * 180) / Math.PI;

export async function testMesh({ page, folder, step, picture, checkRules, call, graspdb, refused }) {
  await call("CatalogService/DeleteObject", { name: "objects/stepped-block", force: true });  // the demo's, taught from captures
  const set = join(folder, "block");
  graspdb("simulate", "--parts", "stepped-block", "--random", "1", "--seed", "9", "--out", set);
  const file = join(set, "models/stepped-block.ply");
  const expected = JSON.parse(graspdb("teach", "stepped-block", "--mesh", file, "--unit", "m", "--dry-run", "--json")).stablePoses;
  const objects = async () => ((await call("CatalogService/ListObjects", {})).objects ?? []).map((each) => each.name);
  const drop = (path) => page.setInputFiles("#teach-files", path);
  const rows = page.locator(".mesh .detection");
  const button = (text) => page.getByRole("button", { name: text, exact: true });

  step("the stable poses of a mesh, as of the command line, and a wrong unit");
  await page.getByRole("link", { name: "Teach" }).click();
  await drop(file);
  await rows.nth(expected.length - 1).waitFor();
  assert.equal(await rows.count(), expected.length);
  assert.equal(await page.locator("#mesh-object").inputValue(), "stepped-block");
  assert.equal(await page.locator("#mesh-unit").inputValue(), "m", "the unit that fits");
  const text = await page.locator(".mesh .panel").innerText();
  for (const { stablePoseId, grasps } of expected) {
    assert.ok(text.includes(stablePoseId), text);
    for (const grasp of grasps ?? []) assert.ok(text.includes(`${grasp.graspId} opens ${(1000 * grasp.gripperOpeningM).toFixed(0)} mm`), `${stablePoseId}: ${text}`);
  }
  await page.locator(".label").nth(expected.length - 1).waitFor();
  await until(page, "they are drawn with their grasps", (now) => now.all > 20 && now.grasps.count > 30);
  await checkRules("mesh poses");
  await picture("mesh-poses");
  await page.locator("#mesh-unit").selectOption("mm");
  await page.getByText("The size looks wrong.").waitFor();
  assert.match(await page.locator(".mesh aside").first().innerText(), /Choose the unit m\./);
  assert.equal(await rows.count(), 0);
  assert.equal(await button("Draw the views").isDisabled(), true);
  await page.locator("#mesh-unit").selectOption("m");
  await rows.nth(expected.length - 1).waitFor();

  step("a worker draws the views, and is cancelled");
  const taught = expected.slice(0, 3);
  for (const each of expected.slice(taught.length)) await page.getByLabel(`Teach ${each.stablePoseId}`).uncheck();
  await page.locator("#mesh-step").fill("1");
  const started = page.waitForEvent("worker");
  await button("Draw the views").click();
  const worker = await started;
  assert.match(worker.url(), /\/mesh_worker\.js$/);
  await page.getByText(new RegExp(`^View \\d+ of ${360 * taught.length}$`)).waitFor();
  await page.locator(".mesh progress[value]").waitFor();
  const ended = new Promise((resolve) => worker.once("close", resolve));
  await button("Cancel").click();
  await page.getByText("Cancelled.").waitFor();
  await ended;
  assert.equal(await page.locator(".thumbnails button").count(), 0);
  assert.equal(await rows.count(), expected.length, "the stable poses stay");

  step("the views are drawn before anything is stored");
  await page.locator("#mesh-step").fill("20");
  await button("Draw the views").click();
  const count = 18 * taught.length;
  await page.getByText(`${count} views of ${taught.length} stable poses are drawn, and not stored.`).waitFor();
  assert.equal(await page.locator(".thumbnails button").count(), 18);
  const drawn = await until(page, "the views are drawn, coloured by height", (now) => now.all > 200 && now.grasps.count > 30);
  await page.locator(".thumbnails button").nth(3).click();
  assert.equal(await page.locator('.thumbnails [aria-pressed="true"]').count(), 1);
  await until(page, "one view is drawn in one colour", (now) => now.all < 0.7 * drawn.all);
  await page.locator(".thumbnails button").nth(3).click();
  await page.locator(".mesh .right").evaluate((aside) => aside.scrollTo(0, 0));
  await checkRules("mesh views");
  await picture("mesh-views");
  assert.equal((await objects()).includes("objects/stepped-block"), false, "nothing is stored yet");

  step("cancelled while the views are sent, nothing stays");
  let sent = 0;
  let arrived;
  const fifth = new Promise((resolve) => (arrived = resolve));
  await page.route("**/WriteUploadViews", async (route) => {
    if (++sent < 5) return route.continue();
    return arrived();  // this one gets no answer
  });
  await button("Store as drafts").click();
  await fifth;
  await page.getByText(`View 4 of ${count} is sent`).waitFor();
  assert.equal((await objects()).includes("objects/stepped-block"), true, "the drafts are there while it works");
  await button("Cancel").click();
  await page.getByText("Cancelled.").waitFor();
  await page.unroute("**/WriteUploadViews");
  assert.equal((await objects()).includes("objects/stepped-block"), false);
  assert.deepEqual((await call("UploadService/ListUploads", {})).uploads?.filter((each) => each.name.startsWith("uploads/console-")) ?? [], []);

  step("stored as drafts in one revision, and released");
  await button("Store as drafts").click();
  await page.getByText(`${count} views are stored.`).waitFor();
  await checkRules("mesh drafts");
  const history = await call("ObjectHistoryService/ListObjectRevisions", { parent: "objects/stepped-block" });
  assert.equal(Number(history.revisions[0].editCount), count);
  const poses = (await call("CatalogService/ListStablePoses", { parent: "objects/stepped-block" })).stablePoses;
  assert.deepEqual(poses.map((each) => each.name.split("/").pop()), taught.map((each) => each.stablePoseId));
  for (const [i, pose] of poses.entries()) {
    assert.equal(pose.release, "RELEASE_STATE_DRAFT");
    assert.equal(pose.grasps?.length ?? 0, expected[i].grasps?.length ?? 0);
    assert.ok(length(minus(pose.meshPose.position, expected[i].meshPose.position)) < 1e-4, pose.name);
  }
  const scan = join(set, "clouds", readdirSync(join(set, "clouds")).find((each) => each.endsWith(".pcd")));
  const found = () => JSON.parse(graspdb("recognize", scan, "--json")).response.detections.filter((each) => each.object === "objects/stepped-block" && each.status === "OK");
  assert.deepEqual(found(), [], "drafts are not recognised");
  await button("Release").click();
  await page.getByText("stepped-block is released: cells recognise it.").waitFor();

  step("the viewpoints and what is seen are those of the command line");
  const compareViews = async (mine, theirs) => {
    const viewsOf = async (parent) => (await call("CatalogService/ListViews", { parent, pageSize: 100 })).views
      .map((each) => ({ ...each, turn: turnOf(each.objectPose) })).sort((a, b) => a.turn - b.turn);
    const [a, b] = [await viewsOf(mine), await viewsOf(theirs)];
    assert.deepEqual(a.map((each) => each.turn), b.map((each) => each.turn));
    a.forEach((view, i) => {
      assert.ok(length(minus(view.sensorPose.position, b[i].sensorPose.position)) < 1e-9);
      assert.ok(angle(view.sensorPose.orientation, b[i].sensorPose.orientation) < 1e-4);
      assert.ok(Math.abs(view.pointCount / b[i].pointCount - 1) < 0.05, `${view.turn}: ${view.pointCount} and ${b[i].pointCount} points`);
    });
  };
  graspdb("teach", "by-command", "--mesh", file, "--unit", "m", "--poses", "2");
  await compareViews("objects/stepped-block/stablePoses/resting-2", "objects/by-command/stablePoses/resting-2");
  const { sensorPose, objectPose: truth } = JSON.parse(readFileSync(join(set, "captures.json"), "utf8")).captures[0];
  await call("CellService/CreateCell", { cellId: "mesh-cell", cell: { sensorPose } });
  graspdb("teach", "by-cell", "--mesh", file, "--unit", "m", "--poses", "1", "--cell", "mesh-cell", "--step", "120");
  await page.getByRole("link", { name: "Scene" }).click();
  await page.getByRole("link", { name: "Teach" }).click();
  await drop(file);
  await rows.nth(expected.length - 1).waitFor();
  await page.locator("#mesh-object").fill("of-page");
  for (let i = 1; i < expected.length; ++i) await page.getByLabel(`Teach ${expected[i].stablePoseId}`).uncheck();
  await page.locator("#mesh-step").fill("120");
  await page.locator("#mesh-cell").selectOption("cells/mesh-cell");
  assert.equal(await page.locator("#mesh-distance").isDisabled(), true, "the cell has it");
  await button("Draw the views").click();
  await button("Store as drafts").click();
  await page.getByText("3 views are stored.").waitFor();
  await compareViews("objects/of-page/stablePoses/resting-1", "objects/by-cell/stablePoses/resting-1");
  await button("Delete the drafts").click();
  await page.getByText("of-page is deleted.").waitFor();
  assert.equal((await objects()).includes("objects/of-page"), false);
  await call("CellService/DeleteCell", { name: "cells/mesh-cell" });
  for (const name of ["by-command", "by-cell"]) await call("CatalogService/DeleteObject", { name: `objects/${name}`, force: true });

  step("an object that was taught so is recognised, and its pose is right");
  const [detection] = found();
  assert.ok(detection, "it is recognised");
  const apart = length(minus(detection.meshPose.position, truth.position));
  const turned = angle(detection.meshPose.orientation, truth.orientation);
  console.log(`pose: ${(1000 * apart).toFixed(2)} mm, ${turned.toFixed(2)} degrees, score ${detection.score.toFixed(2)}`);
  assert.ok(apart < 0.003 && turned < 2, `${apart} m, ${turned} degrees`);
  await page.getByRole("link", { name: "Scene" }).click();
  await page.setInputFiles("#files", scan);
  await page.getByText("has its sensor pose").waitFor();
  await button("Recognise").click();
  await page.locator(".detection .name").getByText("stepped-block").waitFor();
  assert.match(await page.locator(".headline").innerText(), /^OK/);

  step("files and ids that cannot be taught");
  await page.getByRole("link", { name: "Teach" }).click();
  const broken = join(folder, "broken.stl");
  writeFileSync(broken, "solid broken\nfacet normal 0 0 1\n");
  await drop(broken);
  await page.locator(".banner").getByText("broken.stl is no usable mesh").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  await drop(file);
  await rows.nth(expected.length - 1).waitFor();
  for (let i = 1; i < expected.length; ++i) await page.getByLabel(`Teach ${expected[i].stablePoseId}`).uncheck();
  await page.locator("#mesh-cell").selectOption("");
  await button("Draw the views").click();
  await button("Store as drafts").click();
  await page.locator(".banner").getByText("is released: cells would recognise its new views at once").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  await page.locator("#mesh-object").fill("not/an/id");
  await button("Store as drafts").click();
  await page.locator(".banner").getByText("INVALID_ARGUMENT").waitFor();
  assert.match(await page.locator(".banner").innerText(), /Next step/);
  await page.getByRole("button", { name: "Close" }).click();
  await page.locator("#mesh-distance").fill("4900");
  await button("Draw the views").click();
  await page.locator(".banner").getByText("no part of the object is visible").waitFor();
  refused.push(409, 409, 400);
}
