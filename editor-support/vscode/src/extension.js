// Entry point of the extension: starts the language server and registers tasks, tests, commands and the debugger.
"use strict";

const vscode = require("vscode");
const { Server } = require("./server");
const { registerCommands } = require("./commands");
const { registerDebugger } = require("./debugger");
const { registerTasks } = require("./tasks");
const { registerTests } = require("./tests");

/** The language server, from the activation of the extension to its end. */
let server;

async function activate(context) {
  server = new Server();
  context.subscriptions.push(
    vscode.commands.registerCommand("rpi.restartServer", () => server.restart()),
    vscode.workspace.onDidChangeConfiguration((event) => server.settingsChanged(event)),
    ...registerCommands(),
    ...registerDebugger(),
    registerTasks(),
    registerTests()
  );
  await server.start();
}

async function deactivate() {
  await server?.stop();
}

module.exports = { activate, deactivate };
