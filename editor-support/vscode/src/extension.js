// Starts the language server, `rpic lsp`, and keeps it while the editor runs.
"use strict";

const vscode = require("vscode");

/** The client, while there is one. */
let client;

/** The library that speaks with language servers; without it the extension only colours words. */
function library() {
  try {
    return require("vscode-languageclient/node");
  } catch {
    return undefined;
  }
}

/** Starts a server as the settings have it. */
async function start() {
  const { LanguageClient } = library() ?? {};
  if (LanguageClient === undefined) {
    vscode.window.showWarningMessage(
      "RPI: run `npm install` in the folder of the extension to have findings and completion."
    );
    return;
  }
  const settings = vscode.workspace.getConfiguration("rpi");
  const server = { command: settings.get("server.path", "rpic"), args: ["lsp"] };
  const options = {
    documentSelector: [{ language: "rpi" }],
    outputChannelName: "RPI",
  };
  client = new LanguageClient("rpi", "RPI", server, options);
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    vscode.window.showErrorMessage(
      `RPI: \`${server.command} lsp\` does not start (${error.message}). ` +
        "Is rpic installed, and does the setting rpi.server.path lead to it?"
    );
  }
}

async function stop() {
  const running = client;
  client = undefined;
  await running?.stop();
}

async function restart() {
  await stop();
  await start();
}

async function activate(context) {
  const changed = (event) => event.affectsConfiguration("rpi.server") && restart();
  context.subscriptions.push(
    vscode.commands.registerCommand("rpi.restartServer", restart),
    vscode.workspace.onDidChangeConfiguration(changed)
  );
  await start();
}

module.exports = { activate, deactivate: stop };
