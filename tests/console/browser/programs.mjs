// Programs of graspdb for a test of the page, and modules of the page itself.
import { execFileSync, spawn } from "node:child_process";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { mkdirSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
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

// The bytes of a bundle of a black box with this message in JSON.
export async function bundleBytes(work, out, json) {
  const { build } = createRequire(join(work, "package.json"))("esbuild");
  const outfile = join(out, "bundle_message.mjs");
  await build({
    stdin: {
      contents: 'export { fromJson, toBinary } from "@bufbuild/protobuf"; export { BundleSchema } from "./gen/graspdb/v1/bundle_pb";',
      resolveDir: work,
    },
    bundle: true, format: "esm", outfile, logLevel: "warning",
  });
  const { fromJson, toBinary, BundleSchema } = await import(pathToFileURL(outfile));
  return Buffer.concat([Buffer.from("GBB\x01"), toBinary(BundleSchema, fromJson(BundleSchema, json))]);
}

// A server that has taught nothing, and the console. `graspdb` runs the command line at this server.
export async function emptyServer(bin, folder) {
  mkdirSync(join(folder, "backups"));
  const server = await start(join(bin, "graspdb-server"),
    ["--db", join(folder, "db"), "--listen", "127.0.0.1:0", "--backup-dir", join(folder, "backups")], "listening on ");
  const graspdb = (...args) => execFileSync(join(bin, "graspdb"), ["--server", server, ...args], { stdio: ["ignore", "pipe", "pipe"] }).toString();
  const url = await start(join(bin, "graspdb"), ["--server", server, "console", "--listen", "127.0.0.1:0"], "console on ");
  return { url, graspdb };
}

// The same with taught parts, and a scene of the first one.
export async function taughtServer(bin, folder, parts) {
  const at = (name) => join(folder, name);
  const { url, graspdb } = await emptyServer(bin, folder);
  graspdb("simulate", "--parts", parts.join(","), "--step", "30", "--seed", "7", "--out", at("teach"));
  graspdb("import", at("teach"));
  graspdb("simulate", "--parts", parts[0], "--random", "1", "--seed", "8", "--out", at("scenes"));
  const scene = readdirSync(at("scenes/clouds")).find((name) => name.endsWith(".pcd"));
  return { url, graspdb, scene: at(`scenes/clouds/${scene}`), revision: JSON.parse(graspdb("status", "--json")).catalogRevision };
}
