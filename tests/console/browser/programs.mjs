// Programs of graspdb for a test of the page, and modules of the page itself.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { mkdtempSync, rmSync } from "node:fs";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const running = [];

// Starts a program, and resolves with the rest of the line of its output that begins with `line`.
export function start(program, args, line) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "ignore"] });
  running.push(child);
  return new Promise((found, failed) => {
    createInterface({ input: child.stdout }).on("line", (text) => text.startsWith(line) && found(text.slice(line.length)));
    child.on("error", failed);
    child.on("exit", (status) => failed(new Error(`${program} ended with ${status}`)));
  });
}

export function stopAll() {
  for (const child of running) child.kill("SIGTERM");
}

export function temporaryFolder() {
  const path = mkdtempSync(join(tmpdir(), "console-page-"));
  process.on("exit", () => rmSync(path, { recursive: true, force: true }));
  return path;
}

// A module of console/page, as this program can load it. `work`: where the page was built.
export async function pageModule(work, name, out) {
  const { build } = createRequire(join(work, "package.json"))("esbuild");
  const outfile = join(out, `${name}.mjs`);
  await build({ entryPoints: [join(work, "src", `${name}.ts`)], bundle: true, format: "esm", outfile, logLevel: "warning" });
  return import(pathToFileURL(outfile));
}
