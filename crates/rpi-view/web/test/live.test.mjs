// Test of the page of a run that goes on. RPI_VIEW_URL is the address of `rpi run --view`; `crates/rpi/tests/view.rs` starts it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, open } from "./browser.mjs";

let browser;

before(async () => (browser = await launch()));
after(async () => browser.close());

const state = (page) =>
  page.evaluate(() => {
    const { recording, state } = window.rpiView;
    return { live: recording.isLive, last: recording.last, tick: state.tick, follows: state.isFollowing };
  });

test("a page follows a run, is scrubbed back, and shows the recording at the end", async () => {
  const page = await open(browser, process.env.RPI_VIEW_URL);
  const first = await state(page);
  assert.ok(first.live && first.follows && first.tick === first.last, JSON.stringify(first));
  await page.waitForFunction((last) => window.rpiView.recording.last > last + 200, first.last);
  const later = await state(page);
  assert.equal(later.tick, later.last);
  // Every cycle has a value: no part of the run is missing between two requests.
  const gaps = await page.evaluate(() => {
    const flow = window.rpiView.recording.flow("/device/arm.joint.commanded_position[0]");
    return [flow.topic.spans.length, flow.values().some(Number.isNaN)];
  });
  assert.deepEqual(gaps, [1, false]);
  await page.evaluate(() => window.rpiView.state.seek(20));
  await page.waitForFunction((last) => window.rpiView.recording.last > last + 200, later.last);
  const back = await state(page);
  assert.deepEqual([back.tick, back.follows], [20, false]);
  await page.click("#follow");
  await page.waitForFunction(() => window.rpiView.state.tick === window.rpiView.recording.last);
  await page.click("#tab-net");
  assert.match(await page.getAttribute("canvas.net", "aria-label"), /^Net of Move/);
  await page.evaluate(() => window.rpiView.state.seek(30));
  // The run ends: the page loads its recording.
  await page.waitForFunction(() => window.rpiView && !window.rpiView.recording.isLive && document.querySelector("#page[data-ready]"), undefined, { timeout: 60_000 });
  assert.equal((await state(page)).tick, 30);
  assert.ok(await page.evaluate(() => window.rpiView.recording.head.activity.some((a) => a.path !== "")));
  assert.deepEqual(page.errors, []);
  await page.close();
});
