// console_page_test.mjs BIN WORK DEMO ERRORS_MD OUT: uses the console's page as a person would, in Chromium, before a server with
// the database of the demo. WORK: where the page was built. DEMO: what tests/demo/demo.sh has left. Leaves pictures of the views in OUT.
// Ends with 77 where there is no Chromium.
import { strict as assert } from "node:assert";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { brokenRules, colours, openPage, until } from "./page.mjs";
import { png } from "./depth_png.mjs";
import { demoServer, pageModule, start, stopAll, temporaryFolder } from "./programs.mjs";

const [bin, work, demo, errorsMd, out] = process.argv.slice(2).map((path) => resolve(path));
const chromium = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(chromium)) {
  console.log(`skipped: there is no ${chromium}; install Debian's package chromium`);
  process.exit(77);
}
mkdirSync(out, { recursive: true });
const folder = temporaryFolder();
const at = (name) => join(folder, name);

function step(text) {
  console.log(`== ${text}`);
}

// The same with an empty catalogue, in which only a reader has an identity.
async function withIdentities() {
  writeFileSync(at("identities.jsonl"), execFileSync(join(bin, "graspdb-server"),
    ["token", "reader", "--role", "read", "--out", at("reader.token")]));
  const server = await start(join(bin, "graspdb-server"),
    ["--db", at("db2"), "--listen", "127.0.0.1:0", "--identities", at("identities.jsonl")], "listening on ");
  return start(join(bin, "graspdb"), ["--server", server, "console", "--listen", "127.0.0.1:0"], "console on ");
}

// The scene as a PLY file and as a depth image with its camera.
async function otherFiles(scene) {
  const { readPcd } = await pageModule(work, "files/point_file", folder);
  const { cloud } = readPcd(readFileSync(scene));
  const values = new Float32Array(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength / 4);
  const { width } = cloud;
  const height = values.length / 3 / width;
  const point = (i) => values.subarray(3 * i, 3 * i + 3);
  const measured = [...Array(width * height).keys()].filter((i) => point(i)[2] > 0);
  writeFileSync(at("scene.ply"), `ply\nformat ascii 1.0\nelement vertex ${measured.length}\nproperty float x\nproperty float y\nproperty float z\nend_header\n${measured.map((i) => point(i).join(" ")).join("\n")}\n`);
  // Of a pinhole camera: column = fx * x / z + cx, from the two most distant columns.
  const line = (pixel, ratio) => {
    const [a, b] = [measured.reduce((m, i) => pixel(i) < pixel(m) ? i : m), measured.reduce((m, i) => pixel(i) > pixel(m) ? i : m)];
    const f = (pixel(b) - pixel(a)) / (ratio(b) - ratio(a));
    return [f, pixel(a) - f * ratio(a)];
  };
  const [fx, cx] = line((i) => i % width, (i) => point(i)[0] / point(i)[2]);
  const [fy, cy] = line((i) => Math.floor(i / width), (i) => point(i)[1] / point(i)[2]);
  const rows = Array.from({ length: height }, (_, y) => Array.from({ length: width }, (__, x) => {
    const z = point(y * width + x)[2];
    return z > 0 ? Math.round(z * 10_000) : 0;
  }));
  writeFileSync(at("scene.png"), png(rows));
  writeFileSync(at("intrinsics.json"), JSON.stringify({ width, height, fx, fy, cx, cy, depthUnitM: 0.0001 }));
}

// The last two columns of a row in docs/errors.md: of its last table with the key, as errors of teaching are before.
function advice(key) {
  const row = readFileSync(errorsMd, "utf8").split("\n").findLast((line) => line.startsWith(`| \`${key}\` |`));
  return row.split("|").slice(-3, -1).map((cell) => cell.trim().replace(/\[([^\]]*)\]\([^)]*\)/g, "$1").replace(/[`*]/g, ""));
}

const { url, graspdb, sceneOf } = await demoServer(bin, folder, demo);
const scene = sceneOf("l-bracket");
const { catalogRevision, objectCount } = JSON.parse(graspdb("status", "--json"));
await otherFiles(scene);
const { browser, page, faults, axe } = await openPage(work, chromium, url, "dark");
const picture = (name) => page.screenshot({ path: join(out, `${name}.png`) });
const recognise = async () => {
  const before = await page.locator(".answers .row").count();
  await page.getByRole("button", { name: "Recognise" }).click();
  await page.locator(".answers .row").nth(before).waitFor();
};
const checkRules = async (view) => assert.deepEqual(await brokenRules(page, axe), [], view);

try {
  step("a scene: scan, view, grasps, layers");
  const empty = await colours(page);
  await page.setInputFiles("#files", scene);
  await page.getByText("has its sensor pose").waitFor();
  await until(page, "the scan is drawn", (drawn) => drawn.all > empty.all + 20 && drawn.model.count === 0);
  await recognise();
  assert.match(await page.locator(".headline").innerText(), /^OK · 1 detection/);
  assert.equal(await page.locator(".detection .name").innerText(), "l-bracket");
  const drawn = await until(page, "view and grasps are drawn", (now) => now.model.count > 300 && now.grasps.count > 30);
  const layer = (name) => page.locator(".layers").getByText(name, { exact: true });
  await layer("refined pose").click();
  await until(page, "the layer of the view is off", (now) => now.model.count < drawn.model.count / 10);
  await layer("refined pose").click();
  await layer("grasps").click();
  await until(page, "the layer of the grasps is off", (now) => now.grasps.count < drawn.grasps.count / 10 && now.model.count > 300);
  await layer("grasps").click();
  await layer("rough pose").click();
  await until(page, "the rough pose is drawn", (now) => now.rough.count > 30);
  await layer("rough pose").click();

  step("a click on the object: everything that the answer has");
  const card = page.locator(".detection .head");
  assert.equal(await card.getAttribute("aria-expanded"), "true", "the only detection is open");
  await card.click();
  assert.equal(await page.locator(".details").count(), 0);
  const now = await until(page, "the view is drawn", (each) => each.model.count > 300);
  const box = await page.locator(".viewer canvas").boundingBox();
  await page.mouse.click(box.x + now.model.x, box.y + now.model.y);
  await page.locator(".details").waitFor();
  const details = await page.locator(".details").innerText();
  for (const word of ["objects/l-bracket", "refined pose", "rough to refined", "Grasps:", "Candidates"]) assert.ok(details.includes(word), word);
  assert.equal(await page.locator(".details table").nth(1).locator("tbody tr").count(), 10, "ten candidates");
  await picture("scene");
  await checkRules("scene");

  step("why not: status, gate, stages, the next step");
  await page.fill("#minScore", "0.9999");
  await recognise();
  assert.match(await page.locator(".headline").innerText(), /^UNKNOWN_OBJECT/);
  const why = await page.locator(".detection").innerText();
  for (const text of advice("UNKNOWN_OBJECT")) assert.ok(why.includes(text), text);
  for (const text of advice("REJECTION_GATE_MIN_SCORE")) assert.ok(why.includes(text), text);
  assert.equal(await page.locator(".details tbody tr").count() >= 10, true, "candidates with scores");
  assert.ok(await page.locator("table.stages tbody tr").count() > 5);
  await picture("why-not");
  await page.fill("#minScore", "");
  await page.getByText("Region (m, world frame)").click();
  for (const [name, value] of Object.entries({ "x from": 5, "y from": 5, "z from": 0, "x to": 6, "y to": 6, "z to": 1 })) {
    await page.getByLabel(`region, ${name}`).fill(String(value));
  }
  await recognise();
  const nothing = await page.locator(".answer").innerText();
  assert.ok(nothing.includes("No point is left after the stage region"), nothing);
  for (const text of advice("EMPTY_REGION")) assert.ok(nothing.includes(text), text);
  for (const name of ["x from", "y from", "z from", "x to", "y to", "z to"]) await page.getByLabel(`region, ${name}`).fill("");
  await page.fill("#minScore", "7");
  await page.getByRole("button", { name: "Recognise" }).click();
  await page.locator(".banner").getByText("minimum score: 0 to 1").waitFor();
  await page.getByRole("button", { name: "Close" }).click();
  await page.fill("#minScore", "");

  step("two answers side by side");
  const rows = page.locator(".answers .row");
  await rows.nth(2).locator(".pick").click();
  await rows.nth(1).locator(".beside").click();
  await page.locator(".pane-title").nth(1).waitFor();
  const table = await page.locator(".comparison").innerText();
  for (const word of ["Answers 1 and 2", "minimum score 0.9999", "UNKNOWN_OBJECT", "l-bracket, OK"]) assert.ok(table.includes(word), word);
  await until(page, "both are drawn", (each) => each.model.count > 100);
  await picture("side-by-side");
  await checkRules("side by side");
  await page.locator(".label.bad").click();
  assert.match(await page.locator(".comparison").innerText(), /Answers 2 and 1/, "the clicked one becomes the first");
  assert.ok((await page.locator(".detection.selected").innerText()).includes("UNKNOWN_OBJECT"));

  step("other files");
  await page.setInputFiles("#files", [at("scene.png"), at("intrinsics.json")]);
  await page.getByText("scene.png").first().waitFor();
  await recognise();
  assert.match(await page.locator(".headline").innerText(), /^OK/);
  assert.equal(await page.locator(".detection .name").innerText(), "l-bracket");
  await page.setInputFiles("#files", at("scene.ply"));
  await page.getByText("scene.ply").first().waitFor();
  await recognise();
  assert.equal(await page.locator(".detection .name").first().innerText(), "l-bracket");
  writeFileSync(at("bad.pcd"), "DATA ascii\n");
  await page.setInputFiles("#files", at("bad.pcd"));
  await page.locator(".banner").getByText("bad.pcd").waitFor();

  step("the catalogue");
  await page.getByRole("link", { name: "Catalogue" }).click();
  await page.locator(".objects button").nth(objectCount - 1).waitFor();
  assert.equal(await page.locator(".objects button").count(), Number(objectCount));
  await page.getByLabel("Find an object").fill("flange");
  assert.equal(await page.locator(".objects button").count(), 1);
  await page.locator(".objects button").click();
  await page.getByRole("heading", { name: "Flange" }).waitFor();
  assert.equal(await page.locator(".views .row").count(), 24);
  await until(page, "the views are drawn", (each) => each.all > 200);
  await picture("catalogue");
  await checkRules("catalogue");
  await page.locator(".views .pick").first().click();
  await page.locator('.views .pick[aria-pressed="true"]').waitFor();
  // The descriptor that the server uses comes first. Every part of each has bins.
  await page.locator(".descriptors canvas").first().waitFor();
  assert.deepEqual(await page.locator(".descriptors h4").allInnerTexts(), ["gsh288288 bins, finds the views", "vfh263263 bins", "mvfh300300 bins", "vfh308308 bins"]);
  const histograms = await page.locator(".descriptors canvas").evaluateAll((all) => all.map((each) => {
    const { data } = each.getContext("2d").getImageData(0, 0, each.width, each.height);
    return { part: each.getAttribute("aria-label"), pixels: data.filter((value, i) => i % 4 === 3 && value > 0).length };
  }));
  assert.deepEqual(histograms.filter(({ pixels }) => pixels < 20).map(({ part }) => part), ["vfh308 distance"]);  // PCL leaves it empty
  assert.equal(histograms.length, 3 + 4 + 6 + 5);
  await page.locator(".descriptors").scrollIntoViewIfNeeded();
  await picture("descriptors");
  await checkRules("descriptors");
  await page.locator(".views .beside").first().click();
  await page.getByText("flange / ").first().waitFor();
  assert.equal(await page.locator("#segmented").isChecked(), true);
  await recognise();
  assert.equal(await page.locator(".detection .name").innerText(), "flange");

  step("health");
  await page.getByRole("link", { name: "Health" }).click();
  await page.getByText("serving").waitFor();
  const health = await page.locator(".health").innerText();
  assert.ok(health.replace(/\s+/g, " ").includes(`revision ${catalogRevision} `), health);
  assert.match(health, /6 answers, median/);
  for (const stage of ["region", "clusters", "match"]) assert.ok(health.includes(stage), stage);
  await picture("health");
  await checkRules("health");

  step("the keyboard alone");
  await page.getByRole("link", { name: "graspdb" }).focus();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await page.locator(".viewer canvas").focus();
  const before = await until(page, "the scene is drawn", (each) => each.model.count > 20);
  for (let i = 0; i < 6; ++i) await page.keyboard.press("-");
  await until(page, "minus zooms out", (each) => each.model.count > 0 && each.model.count < 0.7 * before.model.count);

  step("light");
  await page.emulateMedia({ colorScheme: "light" });
  await page.getByRole("link", { name: "Catalogue" }).click();
  await until(page, "the stable pose is drawn on light ground", (each) => each.all > 200);
  await picture("catalogue-light");
  await checkRules("light");

  assert.deepEqual(await page.evaluate(() => globalThis.refusals), [], "refusals of the policy");
  assert.deepEqual(faults, [], "errors of the page");

  step("a server with identities takes the browser's token");
  await page.goto(await withIdentities());
  await page.locator(".banner").getByText("UNAUTHENTICATED").waitFor();
  await page.getByLabel("Token").fill(readFileSync(at("reader.token"), "utf8").trim());
  await page.getByRole("button", { name: "Use it" }).click();
  await page.locator(".revision").getByText("revision 0").waitFor();
  assert.deepEqual(await page.evaluate(() => [document.cookie, localStorage.length, sessionStorage.length]), ["", 0, 0]);
  await page.setInputFiles("#files", scene);
  await page.getByRole("button", { name: "Recognise" }).click();
  await page.locator(".banner").getByText("lacks the role").waitFor();
  await page.getByRole("link", { name: "Cells" }).click();
  await page.getByText("There is no cell: create one.").waitFor();
  console.log("done");
} catch (error) {
  await picture("failure");
  console.log(faults.join("\n"));
  throw error;
} finally {
  await browser.close();
  stopAll();
}
