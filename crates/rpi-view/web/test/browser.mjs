// Starts Chromium for the tests of the page. The drawing in 3D uses a renderer without a graphics processor.

import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

/** Places of Chromium as packages of operating systems install it. */
const PLACES = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** Returns the path of a Chromium on this machine; `undefined` if there is none. */
export function chromiumPath() {
  const own = process.env.RPI_CHROMIUM;
  return own ?? [...PLACES, chromium.executablePath()].find((path) => existsSync(path));
}

export function launch() {
  return chromium.launch({
    executablePath: chromiumPath(),
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
}

/** Opens a page at an address and waits until it shows its recording. Fails if the page has an error. */
export async function open(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && page.errors.push(message.text()));
  page.on("request", (request) => {
    const allowed = /^(file|data|blob):/.test(request.url()) || request.url().startsWith(url);
    if (!allowed) page.errors.push(`request to ${request.url()}`);
  });
  await page.goto(url);
  await page.waitForSelector("#page[data-ready]", { timeout: 60_000 });
  return page;
}

/** Moves to a tick and waits until it is shown. */
export async function seek(page, tick) {
  await page.evaluate((tick) => window.rpiView.state.seek(tick), tick);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}
