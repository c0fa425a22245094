#!/usr/bin/env bash
# Fetches the Khronos glTF validator for the test e2e/gltf_validator: one npm package without
# dependencies, into tests/e2e/node_modules. Does nothing when it is there already. Exit 77: it
# cannot be fetched here, and the last line says why; the test is then skipped.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")" || exit 1

skip() { echo "SKIPPED: $1"; exit 77; }
installed() {
    node --input-type=module -e 'import { createRequire } from "node:module";
        const wanted = createRequire(process.cwd() + "/")("./package.json").dependencies;
        const there = createRequire(process.cwd() + "/")("gltf-validator/package.json");
        process.exit(there.version === wanted["gltf-validator"] ? 0 : 1);' 2>/dev/null
}

command -v node >/dev/null ||
    skip "the glTF validator needs node: apt-get install --no-install-recommends nodejs npm"
installed && { echo "glTF validator: installed"; exit 0; }
command -v npm >/dev/null ||
    skip "the glTF validator is fetched with npm: apt-get install --no-install-recommends npm"
# The time-outs keep a machine without a network from waiting for minutes.
said=$(npm ci --ignore-scripts --no-audit --no-fund --loglevel=error \
    --fetch-retries=1 --fetch-timeout=20000 2>&1) ||
    skip "npm could not fetch the glTF validator ($(head -n 1 <<<"$said")): is there a network?"
installed || skip "npm ran, but gltf-validator is not in tests/e2e/node_modules"
echo "glTF validator: fetched"
