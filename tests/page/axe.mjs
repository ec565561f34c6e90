// axe-core in the page, past its policy: the script is run by the debugger, not by the document.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** Fails if axe finds anything. */
export default async function check(page, what) {
  await page.evaluate(`if (!window.axe) { ${source} }`);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  const told = violations.map(({ id, help, nodes }) => `${id}: ${help}\n    ${nodes.slice(0, 5).map((node) => `${node.target} ${node.any[0]?.message ?? ""}`).join("\n    ")}`);
  assert.deepEqual(told, [], what);
}
