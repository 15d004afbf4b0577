// The console's page in Chromium.
import { strict as assert } from "node:assert";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

// Opens `url`. The page's errors, refusals of its policy and requests to other hosts are in `faults`.
export async function openPage(work, executablePath, url, colorScheme) {
  const require = createRequire(join(work, "package.json"));
  const { chromium } = require("playwright-core");
  const browser = await chromium.launch({
    executablePath, args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  const context = await browser.newContext({ viewport: { width: 1440, height: 860 }, colorScheme });
  context.setDefaultTimeout(120_000);  // of a machine with other work
  const page = await context.newPage();
  const faults = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && faults.push(message.text()));
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => !request.url().startsWith(url) && !/^(data|blob):/.test(request.url()) && faults.push(`a request to ${request.url()}`));
  await page.addInitScript(() => {
    globalThis.refusals = [];
    addEventListener("securitypolicyviolation", (event) => globalThis.refusals.push(`${event.violatedDirective}: ${event.blockedURI}`));
  });
  await page.goto(url);
  const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
  return { browser, page, faults, axe };
}

// The colours of the canvas: how many there are, and how many pixels have that of a recognised object's view, of its
// grasps, of its rough pose and of the handle along x, with one of these pixels: the rightmost one of the handle.
export async function colours(page, selector = ".viewer canvas") {
  let box = null;
  while (box === null) box = await page.locator(selector).boundingBox();  // null while one view replaces another
  const bytes = await page.screenshot({ clip: box });
  return page.evaluate(async (base64) => {
    const raw = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([raw], { type: "image/png" }));
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    const out = { all: new Set() };
    const is = {
      model: (r, g, b) => g > 120 && g > r + 60 && g > b + 40,
      grasps: (r, g, b) => r > 160 && g > 80 && g < r - 60 && b < 90,
      rough: (r, g, b) => b > 170 && r > 130 && g < 160,
      handle: (r, g, b) => r > 200 && g < 60 && b < 60,
    };
    for (const name of Object.keys(is)) out[name] = { count: 0, x: 0, y: 0 };
    for (let i = 0; i < data.length; i += 4) {
      const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
      out.all.add((r << 16) | (g << 8) | b);
      for (const name of Object.keys(is)) {
        if (!is[name](r, g, b)) continue;
        ++out[name].count;
        if (name === "handle" && (i / 4) % image.width < out[name].x) continue;
        out[name].x = (i / 4) % image.width;
        out[name].y = Math.floor(i / 4 / image.width);
      }
    }
    return { ...out, all: out.all.size };
  }, bytes.toString("base64"));
}

// Takes the colours again and again until they are as they should be; fails after a minute.
export async function until(page, what, holds) {
  let last;
  for (const end = Date.now() + 60_000; Date.now() < end;) {
    last = await colours(page);
    if (holds(last)) return last;
  }
  assert.fail(`${what}: ${JSON.stringify(last)}`);
}

// Rules of accessibility that the page breaks.
export async function brokenRules(page, axe) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  return violations.map((each) => `${each.id}: ${each.nodes.map((node) => node.target.join(" ")).slice(0, 4).join("; ")}`);
}
