// Tests of the page in Chromium. RPI_REPORTS is a folder with the reports `blending.html`, `lifting.html`, `long.html` and
// `large.html`, RPI_VIEW_URL the address of `rpi view` for the recording of `blending`; `crates/rpi/tests/view.rs` makes
// them.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch, open, seek } from "./browser.mjs";

const folder = process.env.RPI_REPORTS;
const report = (name) => pathToFileURL(join(folder, `${name}.html`)).href;
let browser;

before(async () => (browser = await launch()));
after(async () => browser.close());

const tools = (page) => page.evaluate(() => window.rpiView.cell.toolPositions());
const readout = (page) => page.textContent("#readout");
/** Distance of two points. */
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

test("the tool in 3D is where the device reports it, in every part of the run", async () => {
  const page = await open(browser, report("blending"));
  const last = await page.evaluate(() => window.rpiView.recording.last);
  for (let k = 0; k <= 20; k++) {
    await seek(page, Math.round((k / 20) * last));
    const reported = await page.evaluate(() =>
      ["x", "y", "z"].map((axis) => window.rpiView.recording.flow(`/device/arm.tcp.commanded_position.position.${axis}`).at(window.rpiView.state.tick)),
    );
    const [shown] = await tools(page);
    assert.ok(distance(shown, reported) < 1e-5, `${shown} is not ${reported}`);
  }
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("slider, keys and events move through the run", async () => {
  const page = await open(browser, report("blending"));
  assert.match(await readout(page), /^cycle 0 .*MoveToA/s);
  await page.locator("#slider").focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowRight");
  await page.waitForFunction(() => document.getElementById("readout").textContent.startsWith("cycle 11 "));
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => document.getElementById("readout").textContent.startsWith("cycle 10 "));
  await page.keyboard.press("End");
  await page.waitForFunction(() => window.rpiView.state.tick === window.rpiView.recording.last);
  await page.keyboard.press("Home");
  await page.click("#tab-events");
  const takeover = page.locator(".events .takeover").first();
  assert.match(await takeover.textContent(), /^4\.072 s/);
  await takeover.click();
  // MoveToE takes over in motion in each of the nine rounds; MoveToA and MoveToC start at rest.
  const takeovers = await page.locator(".events .takeover").allTextContents();
  assert.deepEqual(takeovers.map((text) => text.replace(/^\S+ s\s+/, "")), Array(9).fill("MoveToE takes over from MoveToC"));
  await page.waitForFunction(() => window.rpiView.state.tick > 0);
  await page.close();
});

test("both arms of lifting move, each at its place", async () => {
  const page = await open(browser, report("lifting"));
  const start = await tools(page);
  assert.equal(start.length, 2);
  await seek(page, 3000);
  const moved = await tools(page);
  moved.forEach((tool, k) => assert.ok(distance(tool, start[k]) > 0.05, `arm ${k} is at rest`));
  // The arms hold one box: the distance of their tools stays the same while they carry it.
  await seek(page, 3500);
  const later = await tools(page);
  assert.ok(Math.abs(distance(...moved) - distance(...later)) < 1e-3);
  assert.ok(await page.locator(".chart").count() >= 4);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("a condition leads to the cycle in which it begins to hold", async () => {
  const page = await open(browser, report("blending"));
  await page.fill("#condition", "active(MoveToE) and joint.commanded_position[0] > 0.2");
  await page.click("#condition-next");
  await page.waitForFunction(() => window.rpiView.state.tick > 0);
  const [before, at] = await page.evaluate(() => {
    const { recording, state } = window.rpiView;
    const flow = recording.flow("/device/arm.joint.commanded_position[0]");
    const holds = (tick) => recording.commandsAt(tick)[0].command === "MoveToE" && flow.at(tick) > 0.2;
    return [holds(state.tick - 1), holds(state.tick)];
  });
  assert.deepEqual([before, at], [false, true]);
  await page.fill("#condition", "no_such_flow > 1");
  await page.keyboard.press("Enter");
  assert.match(await page.textContent("#condition-message"), /undefined flow `no_such_flow`/);
  await page.fill("#condition", "position > ");
  await page.keyboard.press("Enter");
  assert.equal(await page.getAttribute("#condition", "aria-invalid"), "true");
  await page.close();
});

test("a chart shows derivatives, and exports the visible range", async () => {
  const page = await open(browser, report("blending"));
  const chart = page.locator(".chart").first();
  await chart.locator(".orders button").nth(1).click();
  await seek(page, 3000);
  const [speed, difference] = await page.evaluate(() => {
    const flow = window.rpiView.recording.flow("/device/arm.joint.commanded_position[0]");
    return [flow.at(3000, 1), (flow.at(3000) - flow.at(2999)) / 1e-3];
  });
  assert.ok(Math.abs(speed - difference) < 1e-9);
  assert.equal(Number(await chart.locator("output").first().textContent()).toFixed(3), speed.toFixed(3));
  await chart.locator(".orders button").nth(0).click();
  await page.evaluate(() => window.rpiView.state.show(3000, 3050));
  const [download] = await Promise.all([page.waitForEvent("download"), chart.locator("button", { hasText: "CSV" }).click()]);
  const rows = readFileSync(await download.path(), "utf8").trim().split("\r\n");
  assert.equal(rows.length, 51);
  assert.match(rows[0], /^cycle,time \[s\],\/device\/arm\.joint\.commanded_position\[0\] \[rad\]/);
  assert.match(rows[1], /^3000,3\.000,/);
  await page.close();
});

test("the page of the server shows the recorded values exactly", { skip: !process.env.RPI_VIEW_URL }, async () => {
  const page = await open(browser, process.env.RPI_VIEW_URL);
  assert.ok(await page.evaluate(() => window.rpiView.recording.head.exact));
  const rounded = await open(browser, report("blending"));
  const values = (page) => page.evaluate(() => [...window.rpiView.recording.flow("/device/arm.joint.commanded_position[3]").values()]);
  const [exact, near] = [await values(page), await values(rounded)];
  assert.equal(exact.length, near.length);
  const error = Math.max(...exact.map((value, k) => Math.abs(value - near[k])));
  assert.ok(error > 0 && error < 2 ** -29, `${error}`);
  assert.deepEqual(page.errors, []);
  await page.close();
  await rounded.close();
});

/** Opens the net, at a tick. */
async function openNet(page, tick) {
  await page.click("#tab-net");
  await seek(page, tick);
  await page.locator("canvas.net").focus();
}

/** Text in the line below the net. */
const details = (page) => page.textContent("#net-details");

test("the net of the command at the cursor has values of all flows, lines, plots and causes", { skip: !process.env.RPI_VIEW_URL }, async () => {
  const page = await open(browser, process.env.RPI_VIEW_URL);
  // The server replays the whole recording for a plot, which takes its time without optimisation on a busy machine.
  page.setDefaultTimeout(180_000);
  const tick = await page.evaluate(() => window.rpiView.recording.head.activity.find((a) => a.command === "MoveToC" && a.path === "").spans[0][0] + 500);
  await openNet(page, tick);
  assert.match(await page.getAttribute("canvas.net", "aria-label"), /^Net of MoveToC/);
  assert.equal(await page.evaluate(() => window.rpiView.net.shown.net.open.size), 0, "all boxes are closed at first");
  await page.fill("[aria-label='Find a flow in the net']", "way.travelled");
  await page.waitForFunction(() => /^way\.travelled \(flow\)  = \d/.test(document.getElementById("net-details").textContent));
  const shown = Number(/= (\S+)/.exec(await details(page))[1]);
  // The fragment opened, and the library is no file of the recording.
  assert.equal(await page.evaluate(() => window.rpiView.net.shown.net.open.size), 1);
  await page.locator("canvas.net").focus();
  await page.keyboard.press("p");
  await page.waitForFunction(() => [...document.querySelectorAll(".chart h3")].some((title) => title.textContent === "command/MoveToC.way.travelled"));
  const plotted = await page.evaluate((tick) => window.rpiView.recording.flow("/command/MoveToC.way.travelled").at(tick), tick);
  assert.ok(plotted > 0.001 && Math.abs(plotted - shown) < 1e-4, `${plotted} ${shown}`);
  // Out of the fragment: its call is in the program.
  await page.keyboard.press("Escape");
  assert.match(await page.textContent(".source li[aria-current]"), /^ {2}way = Line/);
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => window.rpiView.net.shown.net.open.size), 0);
  await page.fill("[aria-label='Find a flow in the net']", "way.done");
  await page.waitForFunction(() => /^way\.done \(flow\)  = false/.test(document.getElementById("net-details").textContent));
  await page.locator("canvas.net").focus();
  await page.keyboard.press("y");
  await page.waitForSelector("#panel-why .why button");
  const causes = await page.locator("#panel-why .why button").allTextContents();
  assert.match(causes[0], /^way\.done = false (at|from) \d+\.\d+ s/);
  assert.ok(causes.length > 1);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("fragments of a net are lit while they are active, also in a report", async () => {
  const page = await open(browser, report("large"));
  // F0 is active in every second cycle.
  const isLit = () => page.evaluate(() => window.rpiView.net.values.isActive(window.rpiView.net.shown.net, "F0"));
  await openNet(page, 1);
  assert.equal(await isLit(), true);
  await seek(page, 2);
  assert.equal(await isLit(), false);
  // A click selects a box; a double click opens it.
  const centre = await page.evaluate(() => {
    const { shown } = window.rpiView.net;
    const box = shown.net.boxes[0].find((box) => box.name === "F0" && box.kind === "fragment");
    const { x, y, w } = shown.layout.place(box);
    const { left, top } = document.querySelector("canvas.net").getBoundingClientRect();
    window.rpiView.net.bringIntoView(box);
    const { camera } = shown;
    return [left + (x + w / 2 - camera.x) * camera.scale, top + (y + 12 - camera.y) * camera.scale];
  });
  await page.mouse.click(...centre);
  assert.match(await details(page), /^F0 \(fragment\).*inactive/);
  await page.mouse.dblclick(...centre);
  assert.equal(await page.evaluate(() => window.rpiView.net.shown.net.open.size), 1);
  // A report has no server to ask for causes.
  assert.equal(await page.locator("[data-action=why]").count(), 0);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("a net of 20 000 flows is moved and opened with at most 33 ms of script per frame", async () => {
  const page = await open(browser, report("large"));
  const client = await page.context().newCDPSession(page);
  await client.send("Performance.enable", { timeDomain: "threadTicks" });
  const metrics = async () => Object.fromEntries((await client.send("Performance.getMetrics")).metrics.map((m) => [m.name, m.value]));
  await openNet(page, 1);
  const flows = await page.evaluate(() => window.rpiView.net.shown.net.boxes.flat().filter((box) => box.flow !== null && box.kind === "flow").length);
  assert.ok(flows >= 20_000, `${flows} flows`);
  const frame = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  // Select the first fragment, open it, show all, zoom, move on.
  const keys = ["ArrowDown", "Enter", "f", "+", "+", "+", "ArrowDown", "Enter", "ArrowDown", "Enter", "f", "-", "+", "Enter"];
  await page.fill("[aria-label='Find a flow in the net']", "F7");
  await page.locator("canvas.net").focus();
  let longest = 0;
  for (const round of [0, 1, 2]) {
    for (const key of keys) {
      const before = await metrics();
      await page.keyboard.press(key);
      await frame();
      const after = await metrics();
      const each = (after.ScriptDuration - before.ScriptDuration + after.LayoutDuration - before.LayoutDuration) * 1e3;
      // The first round includes the compilation of the script.
      if (round > 0) longest = Math.max(longest, each);
    }
  }
  console.log(`longest frame of a net of ${flows} flows: ${longest.toFixed(1)} ms of script and layout`);
  assert.ok(longest > 0 && longest <= 33, `${longest} ms`);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("every control has a name, and both themes have enough contrast", async () => {
  for (const colorScheme of ["light", "dark"]) {
    const page = await open(browser, report("blending"), { colorScheme });
    const unnamed = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select, [tabindex]")]
        .filter((control) => !(control.getAttribute("aria-label") || control.getAttribute("aria-labelledby") || control.labels?.length || control.textContent.trim()))
        .map((control) => control.outerHTML),
    );
    assert.deepEqual(unnamed, []);
    const contrasts = await page.evaluate(() => {
      const luminance = (colour) => {
        const probe = document.createElement("span");
        probe.style.color = colour;
        document.body.append(probe);
        const parts = getComputedStyle(probe).color.match(/[\d.]+/g).map(Number);
        probe.remove();
        const [r, g, b] = parts.map((part) => (part / 255 <= 0.03928 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const style = getComputedStyle(document.documentElement);
      const of = (name) => luminance(style.getPropertyValue(name));
      const ratio = (a, b) => (Math.max(of(a), of(b)) + 0.05) / (Math.min(of(a), of(b)) + 0.05);
      const names = ["--text", "--faint", "--warning", "--error", "--accent"];
      return names.flatMap((name) => ["--back", "--panel", ...(name === "--text" || name === "--faint" ? ["--lit"] : [])].map((back) => [name, back, ratio(name, back)]));
    });
    // WCAG 2.2, success criterion 1.4.3.
    for (const [name, back, ratio] of contrasts) assert.ok(ratio >= 4.5, `${colorScheme}: ${name} on ${back}: ${ratio}`);
    await page.close();
  }
});

test("an update takes at most 33 ms of script with 100 000 samples per flow", async () => {
  const page = await open(browser, report("long"));
  const cycles = await page.evaluate(() => window.rpiView.recording.last + 1);
  assert.ok(cycles > 100_000, `${cycles} cycles`);
  const client = await page.context().newCDPSession(page);
  // Time of the thread and not of the clock, so that other processes do not count.
  await client.send("Performance.enable", { timeDomain: "threadTicks" });
  const script = async () => (await client.send("Performance.getMetrics")).metrics.find((m) => m.name === "ScriptDuration").value;
  // Each update moves the cycle and the visible time: all charts on the screen are drawn anew.
  const updates = (count) =>
    page.evaluate(async (count) => {
      const { recording, state } = window.rpiView;
      for (let k = 1; k <= count; k++) {
        state.seek(recording.first + ((k * 7919) % recording.last));
        state.show(k * 100, recording.last - k * 100);
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      }
    }, count);
  await updates(5);
  const before = await script();
  await updates(40);
  const each = ((await script()) - before) / 40 * 1e3;
  console.log(`script per update with ${cycles} samples per flow: ${each.toFixed(1)} ms`);
  assert.ok(each > 0 && each <= 33, `${each} ms`);
  await page.close();
});
