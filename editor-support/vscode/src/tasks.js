// Tasks of the editor: check, test and format a project.
"use strict";

const vscode = require("vscode");
const { compilerPath } = require("./programs");

/** Arguments of `rpic` for each action. */
const ACTIONS = {
  check: (path) => ["check", path, "--format", "short"],
  test: (path) => ["test", path, "--format", "short"],
  fmt: (path) => ["fmt", path],
};

function task(definition, scope) {
  const args = ACTIONS[definition.action]?.(definition.path ?? ".");
  if (args === undefined) {
    return undefined;
  }
  const execution = new vscode.ProcessExecution(compilerPath(), args);
  const made = new vscode.Task(definition, scope, definition.action, "rpi", execution, "$rpic");
  made.group = definition.action === "test" ? vscode.TaskGroup.Test : vscode.TaskGroup.Build;
  return made;
}

/** Registers the provider of the tasks. Returns the registration. */
function registerTasks() {
  return vscode.tasks.registerTaskProvider("rpi", {
    provideTasks: () =>
      Object.keys(ACTIONS).map((action) => task({ type: "rpi", action }, vscode.TaskScope.Workspace)),
    resolveTask: (found) => task(found.definition, found.scope ?? vscode.TaskScope.Workspace),
  });
}

module.exports = { registerTasks };
