// The sample drawings, and what is worth typing about them.

export const SAMPLES = [
  {
    name: "poster.svg",
    title: "Poster, 841 × 1189 mm",
    size: /** @type {const} */ ({ mode: "dpi", first: 300, second: 0 }),
    tries: ["art & frame - logo", "sky - sun", "odd(hills, halo, sun, sea)", "atleast(2, sea, hills, halo, sun)"],
  },
  {
    name: "board.svg",
    title: "Circuit board, 50 × 80 mm",
    size: /** @type {const} */ ({ mode: "dpi", first: 1200, second: 0 }),
    tries: ["(copper | ground - clearance) & outline - drill", "ground - clearance", "pads - drill"],
  },
  {
    name: "scene.json",
    title: "Balloon, a JSON scene",
    size: /** @type {const} */ ({ mode: "scale", first: 4, second: 0 }),
    tries: ["balloon & (gores ^ band)", "balloon - band", "odd(sky, sun, far, near, balloon)"],
  },
];
