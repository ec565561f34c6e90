// The commands that do the same as the page.

/** As a word of a POSIX shell. @param {string} text */
const word = (text) => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

/**
 * @typedef {{ file: string, media: string, expr: string, query: Record<string, string | number>, format: string }} Asked
 */

/** @param {Asked} asked */
export function runset({ file, expr, query, format }) {
  const parts = ["runset fill", word(file)];
  if (expr) parts.push("--expr", word(expr));
  for (const [name, value] of Object.entries(query)) parts.push(`--${name} ${value}`);
  parts.push("-o", word(`${stem(file)}.${format}`));
  return parts.join(" ");
}

/** @param {Asked} asked @param {string} url @param {boolean} token */
export function curl({ file, media, format }, url, token) {
  const parts = [`curl --fail --data-binary ${word(`@${file}`)} -H ${word(`Content-Type: ${media}`)}`];
  if (token) parts.push('-H "Authorization: Bearer $RUNSET_TOKEN"');
  parts.push(word(url), "-o", word(`${stem(file)}.${format}`));
  return parts.join(" ");
}

/** A file's name without its folder and extension. @param {string} file */
export const stem = (file) => file.replace(/^.*\//, "").replace(/\.(svg|svgz|json)$/i, "") || "raster";

/** Copies a text. @param {string} text */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Without a secure connection there is no clipboard but this one.
    const area = document.createElement("textarea");
    area.value = text;
    area.className = "unseen";
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
