// Test of the package: `vsce package` has no warning, and the extension contains exactly the files that it needs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const extension = join(dirname(fileURLToPath(import.meta.url)), '..');

function vsce(...args) {
  const program = join(extension, 'node_modules/@vscode/vsce/vsce');
  const run = spawnSync(process.execPath, [program, ...args], { cwd: extension, encoding: 'utf8' });
  const output = run.stdout + run.stderr;
  assert.equal(run.status, 0, output);
  return output;
}

test('the extension is packaged without a warning', () => {
  const folder = mkdtempSync(join(tmpdir(), 'rpi-vsix-'));
  try {
    const output = vsce('package', '--out', join(folder, 'rpi.vsix'));
    assert.doesNotMatch(output, /warning/i);
    assert.match(output, /DONE/);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test('the package has the files that the extension needs, and no other', () => {
  const files = vsce('ls').split('\n').filter((line) => /^[\w.-]+(\/[\w.-]+)*\.?\w*$/.test(line) && !line.startsWith('>'));
  assert.deepEqual(files.filter((name) => !name.includes(' ')).sort(), [
    'LICENSE', 'README.md', 'dist/extension.js', 'icon.png', 'language-configuration.json', 'package.json',
    'snippets/rpi.json', 'syntaxes/rpi.tmLanguage.json',
  ]);
});
