// Test explorer: the `test` declarations of all programs of the workspace.
"use strict";

const vscode = require("vscode");
const { compilerPath, run } = require("./programs");

/** A `test` declaration at the start of a line, with its title. */
const TEST = /^test\s+"((?:[^"\\\n]|\\.)*)"/gm;

/** Registers the test controller. Returns it. */
function registerTests() {
  const controller = vscode.tests.createTestController("rpi", "RPI");
  const runAll = (request, token) => runTests(controller, request, token);
  controller.createRunProfile("Run", vscode.TestRunProfileKind.Run, runAll, true);
  const watcher = vscode.workspace.createFileSystemWatcher("**/*.rpi");
  watcher.onDidChange((uri) => update(controller, uri));
  watcher.onDidCreate((uri) => update(controller, uri));
  watcher.onDidDelete((uri) => controller.items.delete(uri.toString()));
  controller.resolveHandler = async (item) => {
    if (item === undefined) {
      const files = await vscode.workspace.findFiles("**/*.rpi", "**/target/**");
      await Promise.all(files.map((uri) => update(controller, uri)));
    }
  };
  return vscode.Disposable.from(controller, watcher);
}

/** Reads the tests of a file. */
async function update(controller, uri) {
  const text = Buffer.from(await vscode.workspace.fs.readFile(uri)).toString();
  const file = controller.createTestItem(uri.toString(), vscode.workspace.asRelativePath(uri), uri);
  for (const match of text.matchAll(TEST)) {
    const item = controller.createTestItem(match[1], match[1], uri);
    const line = text.slice(0, match.index).split("\n").length - 1;
    item.range = new vscode.Range(line, 0, line, match[0].length);
    file.children.add(item);
  }
  if (file.children.size === 0) {
    controller.items.delete(file.id);
  } else {
    controller.items.add(file);
  }
}

/** Runs the requested tests, one process for each. */
async function runTests(controller, request, token) {
  const results = controller.createTestRun(request);
  const excluded = new Set(request.exclude ?? []);
  const roots = request.include ?? [...controller.items].map(([, item]) => item);
  for (const item of roots.flatMap(leaves)) {
    if (token.isCancellationRequested) {
      results.skipped(item);
    } else if (!excluded.has(item)) {
      await runTest(results, item);
    }
  }
  results.end();
}

/** Returns the tests at or below an item. */
function leaves(item) {
  const children = [...item.children].map(([, child]) => child);
  return children.length === 0 ? [item] : children.flatMap(leaves);
}

async function runTest(results, item) {
  results.started(item);
  const begun = Date.now();
  const args = ["test", item.uri.fsPath, "--filter", item.label, "--format", "short"];
  const { status, output } = await run(compilerPath(), args);
  results.appendOutput(output.replace(/\r?\n/g, "\r\n"), undefined, item);
  const duration = Date.now() - begun;
  if (status === 0) {
    results.passed(item, duration);
  } else {
    results.failed(item, new vscode.TestMessage(output), duration);
  }
}

module.exports = { registerTests };
