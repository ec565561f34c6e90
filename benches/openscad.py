#!/usr/bin/env python3
"""Writes docs/openscad.md: models of Debian's openscad package, drawn by both programs with the same options.

    benches/openscad.py

Needs openscad, xvfb-run, and a release build (cargo build --release). Takes some minutes.
"""

import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXAMPLES = pathlib.Path("/usr/share/openscad/examples")
MODELS = [
    "Basics/CSG", "Basics/CSG-modules", "Basics/linear_extrude", "Basics/logo", "Old/example001", "Old/example002", "Old/example004", "Old/example005", "Old/example006",
    "Old/example017", "Old/example020", "Old/example024", "Parametric/candleStand",
]
OPTIONS = ["--imgsize=320,240", "--projection=p"]
RUNS = 3

HEAD = """# For those who use OpenSCAD

`runset solid` takes OpenSCAD's own options. What `openscad` draws, it draws too, from the tree that `openscad -o model.csg` writes; no display and no OpenGL are needed, and no surface is computed first:

```sh
openscad -o model.csg model.scad
openscad --render -o model.png {options} model.csg      # a surface by CGAL, then OpenGL: on a server under xvfb-run
openscad          -o model.png {options} model.csg      # the preview, by OpenGL
runset solid                   model.csg {options} -o model.png
```

Below are examples of Debian's openscad package (their authors have put them in the public domain, CC0), drawn by both with these options and no other: `openscad --render`, its preview, `runset solid`.
Shades differ: OpenSCAD's light comes from elsewhere, and `--render` forgets colours. Without a camera the model fills the picture: what is left of it with `--render`, the boxes of its parts in the preview and here, and
the preview also shows `%` and `#` parts as glass. Outlines are compared pixel by pixel in `tests/openscad_pictures.rs`; what differs otherwise is in [csg.md](csg.md).

Times are of the whole program from its start to the PNG, wall and processor, in ms, the median of {runs}; `benches/openscad.py` repeats them. openscad runs under xvfb-run with a software OpenGL, whose own start,
which `openscad --version` under xvfb-run takes as well, is {start:.0f} ms of the wall time.

{where}

| model | openscad --render | its preview | runset solid | faster than --render, preview |
|---|---:|---:|---:|---:|
"""


def timed(command, folder):
    """Wall and processor time in ms, medians of some runs."""
    walls, cpus = [], []
    for _ in range(RUNS):
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        walls.append((time.monotonic() - began) * 1e3)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpus.append((after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) * 1e3)
    return sorted(walls)[RUNS // 2], sorted(cpus)[RUNS // 2]


def main():
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    runset, pictures = target / "release/runset", ROOT / "docs/openscad"
    shutil.rmtree(pictures, ignore_errors=True)
    pictures.mkdir()
    xvfb = ["xvfb-run", "-a"]
    rows, shown = "", ""
    with tempfile.TemporaryDirectory() as folder:
        start = timed([*xvfb, "openscad", "--version"], folder)[0]
        for model in MODELS:
            name = model.replace("/", "-")
            csg = pathlib.Path(folder) / f"{name}.csg"
            subprocess.run(["openscad", "-o", csg, EXAMPLES / f"{model}.scad"], check=True, stderr=subprocess.DEVNULL)
            render = timed([*xvfb, "openscad", "--render", "-o", f"{name}.png", *OPTIONS, csg], folder)
            shutil.move(pathlib.Path(folder) / f"{name}.png", pictures / f"{name}-render.png")
            preview = timed([*xvfb, "openscad", "-o", f"{name}.png", *OPTIONS, csg], folder)
            shutil.move(pathlib.Path(folder) / f"{name}.png", pictures / f"{name}-preview.png")
            ours = timed([runset, "solid", csg, *OPTIONS, "-o", f"{name}.png"], folder)
            shutil.move(pathlib.Path(folder) / f"{name}.png", pictures / f"{name}-runset.png")
            cells = [f"{wall:,.0f}, {cpu:,.0f}" for wall, cpu in (render, preview)] + [f"{ours[0]:.1f}, {ours[1]:.1f}"]
            rows += f"| {model} | {cells[0]} | {cells[1]} | {cells[2]} | {render[0] / ours[0]:,.0f}, {preview[0] / ours[0]:,.0f} |\n"
            shown += f"| {model} | ![--render](openscad/{name}-render.png) | ![preview](openscad/{name}-preview.png) | ![runset](openscad/{name}-runset.png) |\n"
    version = subprocess.run(["openscad", "--version"], capture_output=True, text=True, check=True).stderr.strip()
    commit = subprocess.run(["git", "describe", "--always"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    where = f"{time.strftime('%-d %B %Y', time.gmtime())}, commit {commit}, {version}; {os.cpu_count()} cores, load {os.getloadavg()[0]:.2f}"
    head = HEAD.format(options=" ".join(OPTIONS), runs=RUNS, start=start, where=where)
    (ROOT / "docs/openscad.md").write_text(f"{head}{rows}\n| model | openscad --render | its preview | runset solid |\n|---|---|---|---|\n{shown}")


main()
