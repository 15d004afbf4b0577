// build.mjs PROTOC PROTO_FOLDER ERRORS_MD OUT: bundles the page of src/, beside which node_modules is. Writes the files
// of the page into OUT/page, and OUT/page_files.cc, which has them as constants.
import * as esbuild from "esbuild";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { cpSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const [protoc, proto, errors, out] = process.argv.slice(2);

// TypeScript of the contract.
const contract = readdirSync(join(proto, "graspdb/v1")).map((name) => `graspdb/v1/${name}`);
rmSync("gen", { recursive: true, force: true });
mkdirSync("gen");
execFileSync(protoc, [
  `-I${proto}`, `--plugin=protoc-gen-es=${join(process.cwd(), "node_modules/.bin/protoc-gen-es")}`, "--es_out=gen",
  "--es_opt=target=ts", "google/rpc/status.proto", "google/rpc/error_details.proto",
  ...contract,
], { stdio: "inherit" });

// The rows of a table in Markdown: the first column, of code, to the columns after it as plain text.
function tableOf(text, heading) {
  const start = text.indexOf(`## ${heading}\n`);
  if (start < 0) throw new Error(`${errors} has no section ${heading}`);
  const end = text.indexOf("\n## ", start);
  const rows = {};
  let before = "";
  for (const line of text.slice(start, end < 0 ? undefined : end).split("\n")) {
    const cells = line.split(/(?<!\\)\|/).slice(1, -1).map((cell) => cell.trim());
    const key = /^`([A-Z_]+)`$/.exec(cells[0] ?? "");
    if (!key) continue;
    const plain = cells.slice(1).map((cell) => cell.replace(/\[([^\]]*)\]\([^)]*\)/g, "$1").replace(/[`*]/g, ""));
    // "the same" is the action of the row above.
    before = plain[plain.length - 1].replace(/^the same(?=$|;)/, before);
    rows[key[1]] = { meaning: plain[plain.length - 2], action: before };
  }
  if (Object.keys(rows).length === 0) throw new Error(`${errors}: no rows in ${heading}`);
  return rows;
}
const text = readFileSync(errors, "utf8");
const tables = {
  codes: tableOf(text, "Codes"), reasons: tableOf(text, "Reasons"),
  statuses: tableOf(text, "Recognition"), gates: tableOf(text, "Rejection"),
};
writeFileSync("gen/errors.ts", `// The tables of docs/errors.md.
export interface Advice { meaning: string; action: string }
${Object.entries(tables).map(([name, rows]) => `export const ${name}: Record<string, Advice> = ${JSON.stringify(rows, null, 1)};`).join("\n")}
`);

rmSync(join(out, "page"), { recursive: true, force: true });
mkdirSync(join(out, "page"), { recursive: true });
await esbuild.build({
  entryPoints: { console: "src/main.ts", mesh_worker: "src/mesh/mesh_worker.ts" }, splitting: true, chunkNames: "shared-[hash]", bundle: true, minify: true, format: "esm", target: "es2022",
  outdir: join(out, "page"), legalComments: "none", logLevel: "warning",
});
cpSync("src/index.html", join(out, "page/index.html"));
cpSync("src/console.css", join(out, "page/console.css"));

// Text of C++ with these bytes; three digits, so that a digit may follow.
function literal(bytes) {
  const lines = [];
  for (let at = 0; at < bytes.length; at += 4096) {
    let line = "";
    for (const byte of bytes.subarray(at, at + 4096)) {
      const plain = byte >= 32 && byte < 127 && byte !== 34 && byte !== 92 && byte !== 63;
      line += plain ? String.fromCharCode(byte) : `\\${byte.toString(8).padStart(3, "0")}`;
    }
    lines.push(`    "${line}"`);
  }
  return lines.length === 0 ? '    ""' : lines.join("\n");
}

const types = { html: "text/html", js: "text/javascript", css: "text/css" };
const files = readdirSync(join(out, "page")).sort().map((name) =>
  [name === "index.html" ? "/" : `/${name}`, name, `${types[name.split(".").pop()]}; charset=utf-8`]);
let constants = "";
let rows = "";
let total = 0;
files.forEach(([path, name, type], i) => {
  const bytes = readFileSync(join(out, "page", name));
  const zipped = gzipSync(bytes, { level: 9 });
  total += zipped.length;
  constants += `constexpr char kBytes${i}[] =\n${literal(bytes)};\nconstexpr char kGzip${i}[] =\n${literal(zipped)};\n`;
  const etag = createHash("sha256").update(bytes).digest("hex").slice(0, 16);
  rows += `    {"${path}", "${type}", {kBytes${i}, sizeof(kBytes${i}) - 1}, {kGzip${i}, sizeof(kGzip${i}) - 1}, "\\"${etag}\\""},\n`;
});
const limit = 300_000;
if (total > limit) throw new Error(`the page has ${total} bytes compressed, more than ${limit}`);
console.log(`console page: ${total} bytes compressed`);
writeFileSync(join(out, "page_files.cc"), `// Made by console/page/build.mjs.
#include <array>

#include "console/page_file.h"

namespace graspdb::console {
namespace {

${constants}
constexpr std::array<PageFile, ${files.length}> kFiles = {{
${rows}}};

}  // namespace

std::span<const PageFile> PageFiles() { return kFiles; }

}  // namespace graspdb::console
`);
