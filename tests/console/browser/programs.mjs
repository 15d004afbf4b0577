// Programs of graspdb for a test of the page, and modules of the page itself.
import { execFileSync, spawn } from "node:child_process";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
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

// A server and the console. `database`: copied for the server; without it the server has taught nothing. `graspdb` runs the command
// line at this server.
export async function startServer(bin, folder, database) {
  if (database !== undefined) cpSync(database, join(folder, "db"), { recursive: true });
  mkdirSync(join(folder, "backups"));
  const server = await start(join(bin, "graspdb-server"),
    ["--db", join(folder, "db"), "--listen", "127.0.0.1:0", "--backup-dir", join(folder, "backups")], "listening on ");
  const graspdb = (...args) => execFileSync(join(bin, "graspdb"), ["--server", server, ...args], { stdio: ["ignore", "pipe", "pipe"] }).toString();
  const url = await start(join(bin, "graspdb"), ["--server", server, "console", "--listen", "127.0.0.1:0"], "console on ");
  return { url, graspdb };
}

// The same with what tests/demo/demo.sh has left in `demo`: its database, scenes and bundles. `sceneOf`: a scene of a part.
export async function demoServer(bin, folder, demo) {
  const { url, graspdb } = await startServer(bin, folder, join(demo, "db"));
  const files = (name) => readdirSync(join(demo, name)).sort().map((each) => join(demo, name, each));
  const sceneOf = (part) => files("scenes/clouds").find((path) => path.endsWith(`_${part}.pcd`));
  const { captures } = JSON.parse(readFileSync(join(demo, "scenes/captures.json"), "utf8"));
  return { url, graspdb, sceneOf, bundles: files("black-box"), sensorPose: captures[0].sensorPose };
}
