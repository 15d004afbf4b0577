// Teaching from captures.
import { strict as assert } from "node:assert";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { until } from "./page.mjs";

export async function testTeaching({ page, folder, step, picture, checkRules, call, graspdb, refused }) {
  const set = join(folder, "z-bar");
  graspdb("simulate", "--parts", "z-bar", "--step", "60", "--seed", "3", "--out", set);
  const clouds = readdirSync(join(set, "clouds")).filter((name) => name.endsWith(".pcd")).sort().map((name) => join(set, "clouds", name));
  const { stablePoses } = JSON.parse(readFileSync(join(set, "captures.json"), "utf8")).objects[0];
  const drop = (files) => page.setInputFiles("#teach-files", files);
  const store = page.getByRole("button", { name: "Store as a draft" });
  const pointsOf = (name) => call("CatalogService/ListViews", { parent: name }).then((page1) => page1.views);

  step("a capture set is drawn before it is stored");
  await page.getByRole("link", { name: "Teach" }).click();
  const empty = await until(page, "the picture is there", (now) => now.all > 0);
  await drop([join(set, "captures.json"), ...clouds]);
  await page.getByText(`${clouds.length} captures`).waitFor();
  assert.equal(await page.locator("#teach-object").inputValue(), "z-bar");
  assert.equal(await page.locator("#teach-pose").inputValue(), stablePoses[0].stablePoseId);
  assert.equal(await page.getByText("sensor pose known, object pose known").count(), clouds.length);
  await until(page, "the captures are drawn", (now) => now.all > empty.all + 50);
  assert.deepEqual((await call("CatalogService/ListObjects", {})).objects.filter((each) => each.name === "objects/z-bar"), [], "nothing is stored yet");

  step("a draft, drawn as the server has it, and its release");
  await store.click();
  await page.getByText(`${clouds.length} views stored`).waitFor();
  await page.getByText("the draft's views, of the server").waitFor();
  await until(page, "the views are drawn", (now) => now.all > empty.all + 50);
  const name = `objects/z-bar/stablePoses/${stablePoses[0].stablePoseId}`;
  assert.equal((await call("CatalogService/GetObject", { name: "objects/z-bar" })).release, "RELEASE_STATE_DRAFT");
  const draft = await call("CatalogService/GetStablePose", { name });
  assert.equal(draft.release, "RELEASE_STATE_DRAFT");
  assert.equal(draft.grasps.length, stablePoses[0].grasps.length);
  await page.locator(".teach aside").first().evaluate((aside) => aside.scrollTo(0, 0));
  await picture("teach");
  await checkRules("teach");
  // The same views as by the command line.
  const views = await pointsOf(name);
  assert.equal(views.length, clouds.length);
  assert.match(graspdb("import", set, "--dry-run"), new RegExp(`would send 0 views; ${clouds.length} are in the catalogue`));
  await page.getByRole("button", { name: "Release" }).click();
  await page.getByText("is released: cells recognise it.").waitFor();
  for (const [method, record] of [["GetObject", "objects/z-bar"], ["GetStablePose", name]]) {
    assert.equal((await call(`CatalogService/${method}`, { name: record })).release, "RELEASE_STATE_RELEASED");
  }
  assert.match(graspdb("recognize", clouds[1]), /z-bar/);

  step("a turntable, a file that the server refuses, and the end of a draft");
  const few = join(folder, "zz-few.pcd");
  writeFileSync(few, "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 1 0 1 0 0\nPOINTS 2\nDATA ascii\n0 0 0.9\n0.01 0 0.9\n");
  await drop([...clouds, few]);
  await page.getByText(`${clouds.length + 1} captures`).waitFor();
  await page.locator("#teach-object").fill("turned");
  await page.locator("#teach-name").fill("Turned by hand");
  await page.locator("#teach-pose").fill("flat");
  await page.locator("#teach-step").fill("60");
  await page.locator("#teach-x").fill("5");
  await store.click();
  await page.locator(".advice").getByText("1 refused").waitFor();
  assert.match(await page.locator(".advice").innerText(), /zz-few\.pcd: .*\n?.*Next step: /);
  const turned = await pointsOf("objects/turned/stablePoses/flat");
  assert.equal(turned.length, clouds.length);
  const turns = turned.map((each) => Math.round((2 * Math.atan2(each.objectPose.orientation.z ?? 0, each.objectPose.orientation.w ?? 0) * 180) / Math.PI + 360) % 360);
  assert.deepEqual(turns.sort((a, b) => a - b), [0, 60, 120, 180, 240, 300]);
  for (const each of turned) assert.equal(each.objectPose.position.x, 0.005);
  await page.getByRole("button", { name: "Delete the draft" }).click();
  await page.getByText("is deleted.").waitFor();
  assert.deepEqual((await call("CatalogService/ListObjects", {})).objects.filter((each) => each.name === "objects/turned"), []);

  step("a stable pose that is released gets no views");
  await drop([...clouds]);
  await page.locator("#teach-object").fill("flange");
  const { name: released } = (await call("CatalogService/ListStablePoses", { parent: "objects/flange" })).stablePoses[0];
  await page.locator("#teach-pose").fill(released.split("/").pop());
  await store.click();
  await page.locator(".banner").getByText("is released: cells would recognise its new views at once").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  refused.push(409, 409);
}
