// node validate.mjs FILE.glb...: what the Khronos validator says of each file, one line per issue.
// Exit 1 on any error or warning, 77 when the validator is not installed (setup_packages.sh).
import { readFile } from 'node:fs/promises';
import { basename } from 'node:path';

const NO_LIMIT = 0; // of issues that are listed
const SEVERITY = ['error', 'warning', 'information', 'hint'];

let validator;
try {
  validator = (await import('gltf-validator')).default;
} catch {
  console.log('SKIPPED: gltf-validator is not installed: run tests/e2e/setup_packages.sh');
  process.exit(77);
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.glb...');
  process.exit(2);
}

let bad = 0;
for (const file of files) {
  const bytes = new Uint8Array(await readFile(file));
  const report = await validator.validateBytes(bytes, { uri: basename(file), maxIssues: NO_LIMIT });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  console.log(`${basename(file)}: ${numErrors} errors, ${numWarnings} warnings, ` +
              `${numInfos} infos, ${numHints} hints, ${bytes.length} bytes`);
  for (const issue of messages)
    console.log(`  ${SEVERITY[issue.severity]} ${issue.code} ${issue.pointer}: ${issue.message}`);
  bad += numErrors + numWarnings;
}
process.exit(bad ? 1 : 0);
