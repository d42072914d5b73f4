// Takes the pictures of the book: `node test/shots.mjs FOLDER REPORT...`, one picture per report and theme.

import { basename, join } from "node:path";
import { pathToFileURL } from "node:url";
import { launch, open, seek } from "./browser.mjs";

const [folder, ...reports] = process.argv.slice(2);
const browser = await launch();
for (const report of reports) {
  for (const colorScheme of ["light", "dark"]) {
    const page = await open(browser, pathToFileURL(report).href, { colorScheme });
    const [first, last] = await page.evaluate(() => [window.rpiView.recording.first, window.rpiView.recording.last]);
    await seek(page, Math.round(first + 0.37 * (last - first)));
    await page.waitForTimeout(1500);
    await page.screenshot({ path: join(folder, `view-${basename(report, ".html")}-${colorScheme}.png`) });
    if (page.errors.length > 0) console.error(page.errors.join("\n"));
    await page.close();
  }
}
await browser.close();
