// Lifecycle of the language server, `rpic lsp`.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { compilerPath, run } = require("./programs");

/** Actions that the message about a missing server offers. */
const OPEN_SETTINGS = "Open Settings";
const INSTALL = "How to Install";

/** Page that describes the installation. */
const INSTALL_PAGE = "https://github.com/rpi-lang/rpi#readme";

class Server {
  /** Client of the running server; undefined if none runs. */
  #client;

  /** Starts the server with the current settings. If it cannot be started, a message offers ways out. */
  async start() {
    const command = compilerPath();
    const { status, output } = await run(command, ["--version"]);
    if (status !== 0) {
      return this.#missing(command, output);
    }
    const settings = vscode.workspace.getConfiguration("rpi");
    const client = new LanguageClient(
      "rpi",
      "RPI",
      { command, args: ["lsp"] },
      {
        documentSelector: [{ language: "rpi" }],
        outputChannelName: "RPI",
        initializationOptions: {
          inlayHints: settings.get("inlayHints"),
          codeLens: settings.get("codeLens"),
          pullDiagnostics: settings.get("pullDiagnostics"),
        },
        synchronize: { configurationSection: "rpi" },
      }
    );
    try {
      await client.start();
      this.#client = client;
    } catch (error) {
      await this.#missing(command, error.message);
    }
  }

  async stop() {
    const running = this.#client;
    this.#client = undefined;
    await running?.stop();
  }

  async restart() {
    await this.stop();
    await this.start();
  }

  /** Restarts the server if a setting changed that it reads only at its start. */
  async settingsChanged(event) {
    const atStart = ["rpi.server.path", "rpi.pullDiagnostics"];
    if (atStart.some((name) => event.affectsConfiguration(name))) {
      await this.restart();
    }
  }

  async #missing(command, reason) {
    const text =
      `The RPI language server cannot be started: \`${command} lsp\` (${reason.trim() || "no output"}). ` +
      "Install rpic, or set its path in rpi.server.path. Without it, only the colours work.";
    const chosen = await vscode.window.showErrorMessage(text, OPEN_SETTINGS, INSTALL);
    if (chosen === OPEN_SETTINGS) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "rpi.server.path");
    } else if (chosen === INSTALL) {
      await vscode.env.openExternal(vscode.Uri.parse(INSTALL_PAGE));
    }
  }
}

module.exports = { Server };
