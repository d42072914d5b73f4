// Test of the package: `vsce package` has no warning, and the extension contains exactly the files that it needs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { PackageManager, listFiles } from '@vscode/vsce';

const extension = join(dirname(fileURLToPath(import.meta.url)), '..');

test('the extension is packaged without a warning', () => {
  const folder = mkdtempSync(join(tmpdir(), 'rpi-vsix-'));
  try {
    const program = join(extension, 'node_modules/@vscode/vsce/vsce');
    const args = [program, 'package', '--out', join(folder, 'rpi.vsix')];
    const run = spawnSync(process.execPath, args, { cwd: extension, encoding: 'utf8' });
    const output = run.stdout + run.stderr;
    assert.equal(run.status, 0, output);
    assert.doesNotMatch(output, /warning/i);
    assert.match(output, /DONE/);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test('the package has the files that the extension needs, and no other', async () => {
  const files = await listFiles({ cwd: extension, packageManager: PackageManager.None });
  assert.deepEqual(files.sort(), [
    'LICENSE', 'README.md', 'dist/extension.js', 'icon.png', 'language-configuration.json', 'package.json',
    'snippets/rpi.json', 'syntaxes/rpi.tmLanguage.json',
  ]);
});
