// real_frame_test.mjs BIN WORK FRAMES OUT: a frame of a real camera with an object that is lost, on the console's page: the
// page says at which step, and why. FRAMES: ../shared/data/real_frames. Ends with 77 where these, or Chromium, are missing.
import { strict as assert } from "node:assert";
import { existsSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { openPage } from "./page.mjs";
import { startServer, stopAll, temporaryFolder } from "./programs.mjs";

const [bin, work, frames, out] = process.argv.slice(2).map((path) => resolve(path));
const chromium = process.env.CHROMIUM ?? "/usr/bin/chromium";
const frame = join(frames, "frames/bk0.pcd");
for (const needed of [chromium, frame]) {
  if (existsSync(needed)) continue;
  console.log(`skipped: there is no ${needed}`);
  process.exit(77);
}
mkdirSync(out, { recursive: true });

// Of the basket the camera measured the near side and a part of the rim.
const { url, graspdb } = await startServer(bin, temporaryFolder());
graspdb("teach", "basket", "--mesh", join(frames, "meshes/basket.ply"), "--unit", "mm");
const { browser, page, faults } = await openPage(work, chromium, url, "dark");
try {
  await page.setInputFiles("#files", frame);
  await page.getByRole("button", { name: "Recognise" }).click();
  await page.locator(".answers .row").first().waitFor();
  assert.match(await page.locator(".headline").innerText(), /^UNKNOWN_OBJECT/);
  const cards = await page.locator(".detection").allInnerTexts();
  const basket = cards.find((text) => text.includes("Closest: basket"));
  assert.ok(basket, `what the basket is taken for: ${cards.join("; ")}`);
  assert.match(basket, /REJECTION_GATE_MODEL: surfaces are missing where the object should be visible/);
  assert.match(basket, /Next step: /);
  const stages = await page.locator("table.stages").innerText();
  for (const stage of ["clusters", "register", "propose", "confirm"]) assert.ok(stages.includes(stage), stages);
  assert.deepEqual(faults, []);
  await page.screenshot({ path: join(out, "real-frame.png") });
} finally {
  await browser.close();
  stopAll();
}
