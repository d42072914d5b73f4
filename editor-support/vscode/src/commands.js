// Commands of the code lenses and of the palette: run, test, show a net, list references.
"use strict";

const vscode = require("vscode");
const { compilerPath, run, runnerPath } = require("./programs");

/** Runs a program in a terminal of its own, which stays open. */
function inTerminal(name, path, args) {
  const task = new vscode.Task(
    { type: "rpi", action: name },
    vscode.TaskScope.Workspace,
    name,
    "rpi",
    new vscode.ProcessExecution(path, args),
    "$rpic"
  );
  return vscode.tasks.executeTask(task);
}

function runDeclaration(file, name) {
  return inTerminal(`run ${name}`, runnerPath(), ["run", file, "--command", name]);
}

function runTest(file, title) {
  return inTerminal(`test ${title}`, compilerPath(), ["test", file, "--filter", title]);
}

/** Opens the drawing of a net as text for Mermaid, beside the program. */
async function showNet(file, name) {
  const { status, output } = await run(compilerPath(), ["graph", file, "--command", name]);
  if (status !== 0) {
    return vscode.window.showErrorMessage(`The net of ${name} cannot be drawn: ${output}`);
  }
  const content = `\`\`\`mermaid\n${output}\`\`\`\n`;
  const document = await vscode.workspace.openTextDocument({ language: "markdown", content });
  await vscode.window.showTextDocument(document, vscode.ViewColumn.Beside);
}

/** Lists the references that a code lens counts. The positions are those of the protocol. */
function showReferences(uri, position, locations) {
  const place = (at) => new vscode.Position(at.line, at.character);
  const range = (of) => new vscode.Range(place(of.start), place(of.end));
  const all = locations.map((one) => new vscode.Location(vscode.Uri.parse(one.uri), range(one.range)));
  return vscode.commands.executeCommand(
    "editor.action.showReferences",
    vscode.Uri.parse(uri),
    place(position),
    all
  );
}

async function runFile() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== "rpi") {
    return vscode.window.showInformationMessage("Open a program (.rpi) to run it.");
  }
  await document.save();
  return inTerminal("run", runnerPath(), ["run", document.fileName]);
}

function check() {
  return inTerminal("check", compilerPath(), ["check", ".", "--format", "short"]);
}

/** Registers all commands. Returns their registrations. */
function registerCommands() {
  const commands = {
    "rpi.run": runDeclaration,
    "rpi.runTest": runTest,
    "rpi.showNet": showNet,
    "rpi.showReferences": showReferences,
    "rpi.runFile": runFile,
    "rpi.check": check,
  };
  const register = ([name, action]) => vscode.commands.registerCommand(name, action);
  return Object.entries(commands).map(register);
}

module.exports = { registerCommands };
