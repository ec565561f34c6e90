// Places in texts, as the service names them.

/**
 * Where a place stands in a text.
 * @param {string} text
 * @param {number} line from 1
 * @param {number} column in characters, from 1
 */
export function offset(text, line, column) {
  const lines = text.split("\n");
  const before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
  return before + [...(lines[line - 1] ?? "")].slice(0, column - 1).join("").length;
}
