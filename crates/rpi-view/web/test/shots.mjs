// Takes the pictures of the book from reports of the examples: `node test/shots.mjs FOLDER`, with the reports
// `lifting.html` and `blending.html` in RPI_REPORTS, and the address of `rpi view` for a recording of blending in RPI_VIEW_URL.

import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { launch, open, seek } from "./browser.mjs";

const [folder] = process.argv.slice(2);
const browser = await launch();

const report = (name) => pathToFileURL(join(process.env.RPI_REPORTS, `${name}.html`)).href;

async function shot(name, colorScheme, tick, prepare, url = report(name)) {
  const page = await open(browser, url, { colorScheme });
  await prepare(page);
  await seek(page, tick);
  await page.waitForTimeout(1000);
  await page.screenshot({ path: join(folder, `view-${name}.png`) });
  if (page.errors.length > 0) throw new Error(page.errors.join("\n"));
  await page.close();
}

await shot("lifting", "light", 3585, async () => {});
await shot("blending", "dark", 4200, async (page) => {
  // The velocity of one axis with its limits, around a takeover.
  await page.evaluate(() => window.rpiView.state.show(0, 13_000));
  const chart = page.locator(".chart").first();
  await chart.locator(".orders button").nth(1).click();
  await chart.locator(".legend button").first().dblclick();
  await page.click("#tab-events");
});
// The net of MoveToC while it can be taken over, with an open fragment.
const net = async (page) => {
  await page.click("#tab-net");
  await page.evaluate(() => window.rpiView.state.show(0, 13_000));
  await seek(page, 4000);
  await page.evaluate(() => {
    const { net } = window.rpiView;
    net.show("MoveToC", "PastB.yes");
    net.fit();
  });
};
await shot("net", "light", 4000, net, process.env.RPI_VIEW_URL);
await browser.close();
