// Debugging: starts `rpi debug` for a recording, or for a program that is run first.
"use strict";

const vscode = require("vscode");
const { runnerPath } = require("./programs");

/** Fills a configuration with the program of the active editor if it names nothing. */
function resolveConfiguration(_folder, config) {
  if (config.program || config.recording) {
    return config;
  }
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== "rpi") {
    vscode.window.showErrorMessage("Open a program (.rpi) to debug it, or name a recording in launch.json.");
    return undefined;
  }
  return { ...config, type: "rpi", request: "launch", name: "RPI", program: document.uri.fsPath };
}

/** Registers the debugger. Returns the registrations. */
function registerDebugger() {
  return [
    vscode.debug.registerDebugConfigurationProvider("rpi", {
      resolveDebugConfiguration: resolveConfiguration,
    }),
    vscode.debug.registerDebugAdapterDescriptorFactory("rpi", {
      createDebugAdapterDescriptor: () =>
        new vscode.DebugAdapterExecutable(runnerPath(), ["debug", "--dap"]),
    }),
    vscode.commands.registerCommand("rpi.debugFile", (uri) =>
      vscode.debug.startDebugging(undefined, {
        type: "rpi",
        request: "launch",
        name: "RPI",
        program: (uri ?? vscode.window.activeTextEditor?.document.uri)?.fsPath,
      })
    ),
  ];
}

module.exports = { registerDebugger };
