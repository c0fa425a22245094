#!/usr/bin/env bash
# Fetches the packages of package.json into tests/e2e/node_modules: the Khronos glTF validator, TinyUSDZ, three.js with
# three-vrm, an OSC reader. Does nothing where all are there; --installed only asks that. Exit 77: they cannot be fetched, and the
# last line says why. The tests that need them are then skipped.
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

installed && exit 0
[ "${1:-}" != --installed ] || exit 1
command -v npm >/dev/null || skip "npm is not installed: apt-get install --no-install-recommends npm"
# The time-outs keep a machine without a network from waiting for minutes.
said=$(npm ci --ignore-scripts --no-audit --no-fund --loglevel=error \
    --fetch-retries=1 --fetch-timeout=20000 2>&1) ||
    skip "npm could not fetch the packages of tests/e2e/package.json ($(head -n 1 <<<"$said")): is there a network?"
installed || skip "npm ran, but not all of package.json is in tests/e2e/node_modules"
