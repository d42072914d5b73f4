// Paths of the programs `rpic` and `rpi`, and running them.
"use strict";

const { spawn } = require("node:child_process");
const vscode = require("vscode");

/** Returns the path of `rpic` in the settings. */
function compilerPath() {
  return vscode.workspace.getConfiguration("rpi").get("server.path", "rpic");
}

/** Returns the path of `rpi` in the settings. */
function runnerPath() {
  return vscode.workspace.getConfiguration("rpi").get("runner.path", "rpi");
}

/**
 * Runs a program and resolves to its exit status and output. Never rejects: a program that cannot be started has the
 * status `null` and the reason as its output.
 */
function run(path, args, options = {}) {
  return new Promise((resolve) => {
    const child = spawn(path, args, options);
    const parts = [];
    child.stdout?.on("data", (data) => parts.push(data));
    child.stderr?.on("data", (data) => parts.push(data));
    child.on("error", (error) => resolve({ status: null, output: error.message }));
    child.on("close", (status) => resolve({ status, output: Buffer.concat(parts).toString() }));
  });
}

module.exports = { compilerPath, runnerPath, run };
