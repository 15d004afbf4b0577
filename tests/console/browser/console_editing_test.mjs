// console_editing_test.mjs BIN WORK DEMO OUT [VIEW]: changes the catalogue of the demo by the console's page as a person would, in
// Chromium. WORK: where the page was built. DEMO: what tests/demo/demo.sh has left. Leaves pictures of the views in OUT. VIEW: only that
// one. Ends with 77 where there is no Chromium.
import { strict as assert } from "node:assert";
import { existsSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { testCatalogue } from "./catalogue_steps.mjs";
import { testCells } from "./cell_steps.mjs";
import { testGrasps } from "./grasp_steps.mjs";
import { testLookAlikes } from "./look_alike_steps.mjs";
import { testMesh } from "./mesh_steps.mjs";
import { brokenRules, openPage } from "./page.mjs";
import { demoServer, stopAll, temporaryFolder } from "./programs.mjs";
import { testTeaching } from "./teach_steps.mjs";

const [bin, work, demo, out] = process.argv.slice(2).map((path) => resolve(path));
const chromium = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(chromium)) {
  console.log(`skipped: there is no ${chromium}; install Debian's package chromium`);
  process.exit(77);
}
mkdirSync(out, { recursive: true });
const folder = temporaryFolder();
const server = await demoServer(bin, folder, demo);
const { browser, page, faults, axe } = await openPage(work, chromium, server.url, "dark");

const test = {
  page, folder, work, ...server,
  refused: [],  // statuses of calls that the server was to refuse
  step: (text) => console.log(`== ${text}`),
  picture: (name) => page.screenshot({ path: join(out, `${name}.png`) }),
  // In both colour schemes.
  checkRules: async (view) => {
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      assert.deepEqual(await brokenRules(page, axe), [], `${view}, ${colorScheme}`);
      if (colorScheme === "light") await test.picture(`${view.replaceAll(" ", "-")}-light`);
    }
  },
  // A call of the server, in JSON.
  call: async (method, request) => {
    const response = await fetch(`${server.url}graspdb.v1.${method}`,
      { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(request) });
    const answer = await response.json();
    assert.equal(response.status, 200, JSON.stringify(answer));
    return answer;
  },
};
const views = { catalogue: testCatalogue, grasps: testGrasps, teach: testTeaching, mesh: testMesh, lookAlikes: testLookAlikes, cells: testCells };

try {
  for (const [view, run] of Object.entries(views)) {
    if (process.argv[6] === undefined || process.argv[6] === view) await run(test);
  }
  assert.deepEqual(await page.evaluate(() => globalThis.refusals), [], "refusals of the policy");
  // Chromium reports the calls that were to be refused, too.
  assert.deepEqual(faults.map((fault) => Number(/^Failed to load resource.* status of (\d+)/.exec(fault)?.[1]) || fault), test.refused, "errors of the page");
  console.log("done");
} catch (error) {
  await test.picture("editing-failure");
  console.log(faults.join("\n"));
  throw error;
} finally {
  await browser.close();
  stopAll();
}
