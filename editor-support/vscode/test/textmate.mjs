// Test of the TextMate grammar: it colours every program of the repository, and the samples as the snapshots say.
// `RPI_BLESS=1 npm test` writes the snapshots.
import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import oniguruma from 'vscode-oniguruma';
import textmate from 'vscode-textmate';

const extension = join(dirname(fileURLToPath(import.meta.url)), '..');
const root = join(extension, '../..');
const samples = join(root, 'editor-support/samples');
const grammarFile = join(extension, 'syntaxes/rpi.tmLanguage.json');

// Folders with programs that have no deliberate errors; the test of the grammar for tree-sitter reads the same list.
const folders = readFileSync(join(samples, 'program-folders.txt'), 'utf8').trim().split('\n');

async function loadGrammar() {
  const wasm = readFileSync(join(extension, 'node_modules/vscode-oniguruma/release/onig.wasm'));
  await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(readFileSync(grammarFile, 'utf8'), grammarFile),
  });
  return registry.loadGrammar('source.rpi');
}

function programs(folder) {
  const entries = readdirSync(folder, { withFileTypes: true });
  return entries.flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return programs(path);
    return /\.(rpi|lus)$/.test(entry.name) ? [path] : [];
  });
}

// Returns the tokens of each line, and whether a region such as a comment is still open at the end.
function colour(grammar, text) {
  let state = textmate.INITIAL;
  const lines = text.split(/\r?\n/).map((line) => {
    const result = grammar.tokenizeLine(line, state);
    state = result.ruleStack;
    const tokens = result.tokens.map((token) => ({
      text: line.slice(token.startIndex, token.endIndex),
      scope: token.scopes.length > 1 ? token.scopes.at(-1) : undefined,
    }));
    return { line, tokens };
  });
  return { lines, isOpen: state.depth > 1 };
}

function snapshot({ lines }) {
  const text = lines.map(({ line, tokens }) => {
    const scopes = tokens.filter((token) => token.scope && token.text.trim());
    return [line, ...scopes.map((token) => `    ${token.text.trim()}  ${token.scope}`)].join('\n');
  });
  return text.join('\n').trimEnd() + '\n';
}

const grammar = await loadGrammar();

test('every program of the repository is coloured to its end', () => {
  const files = folders.flatMap((folder) => programs(join(root, folder)));
  assert.ok(files.length > 100, `${files.length} programs`);
  for (const file of files) {
    const { lines, isOpen } = colour(grammar, readFileSync(file, 'utf8'));
    const name = relative(root, file);
    assert.ok(!isOpen, `${name}: a region is open at the end of the file`);
    const tokens = lines.flatMap(({ tokens }) => tokens);
    const invalid = tokens.find((token) => token.scope?.startsWith('invalid'));
    assert.equal(invalid, undefined, name);
    assert.ok(tokens.some((token) => token.scope?.startsWith('keyword')), `${name}: no keyword has a colour`);
  }
});

for (const sample of readdirSync(samples).filter((name) => /\.(rpi|lus)$/.test(name))) {
  test(`the colours of ${sample} are those of the snapshot`, () => {
    const got = snapshot(colour(grammar, readFileSync(join(samples, sample), 'utf8')));
    const file = join(samples, `${sample}.textmate.txt`);
    if (process.env.RPI_BLESS) writeFileSync(file, got);
    assert.ok(existsSync(file), `${file} is missing: RPI_BLESS=1 npm test`);
    assert.equal(got, readFileSync(file, 'utf8'));
  });
}
