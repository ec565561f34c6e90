// The samples: drawings with what is worth typing about them, and models.

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

export const MODELS = [
  { name: "bracket.csg", title: "Bracket with holes" },
  { name: "cubes.csg", title: "Cubes that share faces" },
  { name: "sponge.csg", title: "Sponge of two levels" },
];
