#!/usr/bin/env bash
# Fetches what package.json lists into tests/e2e/node_modules: the Khronos glTF validator for
# e2e/gltf_validator, TinyUSDZ, a USD library, for e2e/usd, three.js with three-vrm for e2e/three
# and e2e/vrm_live, an OSC reader for the latter.
# Does nothing when all is there already. Exit 77: it cannot be fetched here, and the last line says why; those tests are then
# skipped.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")" || exit 1

skip() { echo "SKIPPED: $1"; exit 77; }
installed() {
    node --input-type=module -e 'import { createRequire } from "node:module";
        import { readFileSync } from "node:fs";
        const wanted = createRequire(process.cwd() + "/")("./package.json").dependencies;
        for (const name in wanted) {
            const there = JSON.parse(readFileSync(`node_modules/${name}/package.json`));
            if (there.version !== wanted[name]) process.exit(1);
        }' 2>/dev/null
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
installed || skip "npm ran, but not all of package.json is in tests/e2e/node_modules"
echo "glTF validator: fetched"
