// console_page_test.mjs BIN NODE_MODULES OUT: opens the console's page in Chromium before a server with taught parts, and
// uses it as a person would. Leaves pictures of its views in OUT. Ends with 77 where there is no Chromium.
import { strict as assert } from "node:assert";
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { deflateSync, crc32 } from "node:zlib";

const [bin, modules, out] = process.argv.slice(2).map((path) => resolve(path));
const browserPath = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(browserPath)) {
  console.log(`skipped: there is no ${browserPath}; install Debian's chromium`);
  process.exit(77);
}
const require = createRequire(join(modules, "x.js"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const work = mkdtempSync(join(tmpdir(), "console-page-"));
mkdirSync(out, { recursive: true });
const processes = [];
// Starts a program, and resolves with the rest of its line that begins with `start`.
function start(name, args, line) {
  const child = spawn(join(bin, name), args, { stdio: ["ignore", "pipe", "inherit"] });
  processes.push(child);
  return new Promise((found, failed) => {
    createInterface({ input: child.stdout }).on("line", (text) => text.startsWith(line) && found(text.slice(line.length)));
    child.on("exit", (status) => failed(new Error(`${name} ended with ${status}`)));
  });
}
const parts = "l-bracket,flange,wedge,bracket-left,bracket-right";
