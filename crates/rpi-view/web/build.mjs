// Builds the page: bundles script and style, and puts both into one HTML file, `dist/page.html`. With `--check`, the file
// is not written; the exit status is 1 if it would change.

import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const folder = dirname(fileURLToPath(import.meta.url));
const read = (path) => readFileSync(join(folder, path), "utf8");
const limit = 1_500_000;
/** Packages whose code is in the page. */
const bundled = ["three", "uplot"];

const options = { bundle: true, minify: true, write: false, legalComments: "none", target: "es2023", absWorkingDir: folder };
const script = await build({ ...options, entryPoints: ["src/main.ts"], format: "iife", charset: "utf8" });
const sheet = await build({ ...options, stdin: { contents: `${read("node_modules/uplot/dist/uPlot.min.css")}\n${read("src/style.css")}`, loader: "css" } });
const licences = bundled.map((name) => {
  const { version, license } = JSON.parse(read(`node_modules/${name}/package.json`));
  return `${name} ${version}, ${license}\n\n${read(`node_modules/${name}/LICENSE`).trim()}`;
});
const code = script.outputFiles[0].text.trim().replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const parts = { style: sheet.outputFiles[0].text.trim(), script: code };
let page = read("src/page.html");
for (const [name, text] of Object.entries(parts)) page = page.replace(`<!--${name}-->`, () => text);
page = page.replace("<!doctype html>\n", () => `<!doctype html>\n<!--\nThis page is generated from crates/rpi-view/web/src. It contains:\n\n${licences.join("\n\n")}\n-->\n`);
if (Buffer.byteLength(page) > limit) throw new Error(`the page has ${Buffer.byteLength(page)} bytes, the limit is ${limit}`);
const target = join(folder, "dist/page.html");
if (process.argv.includes("--check")) {
  if (readFileSync(target, "utf8") !== page) {
    console.error("dist/page.html is not up to date: npm run build");
    process.exit(1);
  }
} else writeFileSync(target, page);
console.log(`dist/page.html: ${Buffer.byteLength(page)} bytes`);
