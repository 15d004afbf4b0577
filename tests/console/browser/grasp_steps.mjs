// The editor of grasps.
import { strict as assert } from "node:assert";
import { until } from "./page.mjs";

export async function testGrasps({ page, step, picture, checkRules, call, refused }) {
  const { name } = (await call("CatalogService/ListStablePoses", { parent: "objects/flange" })).stablePoses[0];
  const pose = () => call("CatalogService/GetStablePose", { name });
  const number = async (id) => Number(await page.locator(`#grasp-${id}`).inputValue());

  step("the grasps of a stable pose, with their outcomes");
  const before = await pose();
  const first = before.grasps[0];
  for (const outcome of ["PICKED", "PICKED", "SLIPPED"]) {
    await call("CatalogService/ReportGraspOutcome", { name, graspId: first.graspId, outcome: `GRASP_OUTCOME_${outcome}` });
  }
  await page.getByRole("link", { name: "Catalogue" }).click();
  await page.locator(".objects button").getByText("Flange with").click();
  await page.getByRole("heading", { name: "Flange" }).waitFor();
  await page.getByRole("link", { name: "Edit the grasps" }).click();
  await page.getByText("2 picked, 0 missed, 1 slipped").waitFor();
  assert.equal(await page.locator("#picked-pose").inputValue(), name);
  assert.equal(await number("opening"), Math.round(first.gripperOpeningM * 1e5) / 100);
  const save = page.getByRole("button", { name: "Save the grasps" });
  assert.equal(await save.isDisabled(), true, "nothing is changed");

  step("a handle moves the tool");
  const drawn = await until(page, "object, grasps and handle are drawn", (now) => now.all > 200 && now.handle.count > 20);
  const canvas = await page.locator(".grasps .viewer canvas").boundingBox();
  const poseNumbers = () => Promise.all(["x", "y", "z", "roll", "pitch", "yaw"].map(number));
  const drag = async ({ x, y }, dx, dy) => {
    await page.mouse.move(canvas.x + x, canvas.y + y);
    await page.mouse.down();
    for (let i = 1; i <= 4; ++i) await page.mouse.move(canvas.x + x + (dx * i) / 4, canvas.y + y + (dy * i) / 4);
    await page.mouse.up();
  };
  const start = await poseNumbers();
  await drag(drawn.handle, 60, 60);
  const moved = await poseNumbers();
  assert.ok(Math.hypot(moved[0] - start[0], moved[1] - start[1], moved[2] - start[2]) > 2, `${start} ${moved}`);
  assert.deepEqual(moved.slice(3), start.slice(3), "it has not turned");
  await page.getByText(`The outcome counts of ${first.graspId} begin at zero then.`).waitFor();
  assert.equal(await page.locator("#picked-object").isDisabled(), true, "changes are saved or discarded first");
  await page.getByRole("button", { name: "Turn" }).click();
  const ring = await until(page, "the rings are drawn", (now) => now.handle.count > 20);
  await drag(ring.handle, 50, -50);
  const turned = await poseNumbers();
  assert.ok(turned.slice(3).some((value, i) => Math.abs(value - moved[3 + i]) > 2), `${moved} ${turned}`);
  await picture("grasps");
  await checkRules("grasps");

  step("discarded, nothing stays");
  await page.getByRole("button", { name: "Discard the changes" }).click();
  assert.deepEqual(await poseNumbers(), start);
  assert.deepEqual((await pose()).grasps, before.grasps);

  step("numbers, by the keyboard alone, and a second grasp");
  await page.locator("#grasp-opening").focus();
  await page.keyboard.press("ControlOrMeta+A");
  await page.keyboard.type("61.5");
  await page.keyboard.press("Tab");
  await page.keyboard.press("ControlOrMeta+A");
  await page.keyboard.type("123");
  await page.getByRole("button", { name: "Copy" }).focus();
  await page.keyboard.press("Enter");
  await page.locator("#grasp-yaw").fill("30");
  await page.locator("#grasp-turns").check();
  await page.locator("#grasp-min-turn").fill("-45");
  await save.click();
  await page.getByText(/^Saved, revision \d+\.$/).waitFor();
  const saved = await pose();
  assert.equal(saved.grasps.length, before.grasps.length + 1);
  assert.deepEqual([saved.grasps[0].gripperOpeningM, saved.grasps[0].approachDistanceM], [0.0615, 0.123]);
  assert.deepEqual(saved.grasps[0].tcpPose, first.tcpPose, "what was not changed keeps its bits");
  const copy = saved.grasps.at(-1);
  assert.equal(copy.graspId, `${first.graspId.replace(/-\d+$/, "")}-${first.graspId.endsWith("-2") ? 3 : 2}`);
  assert.deepEqual(copy.freeTurn, { minDeg: -45, maxDeg: 180 });
  assert.equal(saved.graspOutcomes, undefined, "the counts begin anew");

  step("a conflict has its next step");
  const conflict = page.locator(".conflict");
  await page.locator("#grasp-priority").fill("7");
  await call("CatalogService/UpdateStablePose",
    { stablePose: { name, grasps: [{ ...saved.grasps[0], priority: 3 }, copy] }, updateMask: "grasps" });
  await save.click();
  await conflict.getByText(`${first.graspId} is changed`).waitFor();
  assert.match(await conflict.innerText(), /Next step/);
  assert.equal((await pose()).grasps[0].priority, 3, "nothing was written");
  await checkRules("a conflict");
  await conflict.getByRole("button", { name: "Replace theirs" }).click();
  await page.getByText(/^Saved, revision \d+\.$/).waitFor();
  assert.equal((await pose()).grasps.at(-1).priority, 7);
  await page.locator("#grasp-priority").fill("8");
  await call("CatalogService/UpdateStablePose", { stablePose: { name, grasps: saved.grasps }, updateMask: "grasps" });
  await save.click();
  await conflict.getByRole("button", { name: "Take theirs" }).click();
  assert.equal(await save.isDisabled(), true);
  assert.equal(await number("priority"), copy.priority ?? 0);

  step("a deleted grasp, and one that the server refuses");
  await page.getByRole("button", { name: "Delete" }).click();
  await page.locator("#grasp-id").fill("not an id");
  await save.click();
  await page.locator(".banner").getByText("stable_pose.grasps").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  await page.locator("#grasp-id").fill(first.graspId);
  await save.click();
  await page.getByText(/^Saved, revision \d+\.$/).waitFor();
  assert.equal((await pose()).grasps.length, before.grasps.length);
  refused.push(409, 409, 400);
}
