#!/usr/bin/env python3
"""Whole processes side by side: ours, Ghostscript, MuPDF, resvg, and libraries behind usvg.

    benches/processes.py [--runs N] [--folder DIR] [pages | vertices | map | sheet]...

Needs Linux, cargo and Python 3.10. Programs that are not installed are named and skipped. Each row of a table is a program; they
run in turn, N times (default 5), writing into a pipe that is emptied without copying. Wall time, processor time (user and system) and
peak memory are medians; more than 30 s of processor time or 4 GB counts as not finishing. `differ` is the number of pixels that are not ours.

    pages      two workloads at 65,536 pixels a side, to PBM, two threads of ours, from SVG (ours also from JSON) or PDF
    vertices   2,000,000 vertices at 16,384 a side, to PBM; libraries are charged with usvg's reading of the same SVG
    map        600,000 vertices in 24 inks on A0 at 600 dots an inch, to PPM or PNG
    sheet      5,000 opaque shapes in black on A0 at 2400 dots an inch, to a TIFF file in CCITT group 4

The workloads are made in DIR (default target/processes) by the example `plane`, about 150 MB.
"""

import argparse
import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECONDS, KIB = 30, 4 << 20


class Stopped(Exception):
    """A program that does not finish within the limits, or fails."""


def build(*arguments):
    """Runs cargo and gives the executables that it made."""
    command = ["cargo", *arguments, "--message-format=json-render-diagnostics"]
    said = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    artifacts = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
    return {a["target"]["name"]: a["executable"] for a in artifacts if a.get("executable")}


def drain(pipe):
    """Takes everything out of a pipe, without copying, and counts it."""
    taken = 0
    with open(os.devnull, "wb") as nowhere:
        while n := os.splice(pipe, nowhere.fileno(), 1 << 20):
            taken += n
    return taken


def run(command):
    """Runs a program: wall and processor seconds, peak KiB, bytes written to the pipe."""
    began = time.monotonic()
    program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    resource.prlimit(program.pid, resource.RLIMIT_CPU, (SECONDS, SECONDS))
    late = threading.Timer(4 * SECONDS, program.kill)
    late.start()
    taken = drain(program.stdout.fileno())
    said = program.stderr.read().decode(errors="replace").strip()
    _, status, usage = os.wait4(program.pid, 0)
    wall = time.monotonic() - began
    late.cancel()
    program.returncode = status
    program.stdout.close()
    program.stderr.close()
    if wall >= 4 * SECONDS or usage.ru_utime + usage.ru_stime >= SECONDS - 1:
        raise Stopped(f"takes more than {SECONDS} s")
    if status != 0:
        raise Stopped("fails: " + (said.splitlines() or ["no message"])[-1])
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss, taken


def rows(pipe):
    """Leaves a PBM at its first row and gives its size."""
    fields = []
    while len(fields) < 3:
        line = pipe.readline().split(b"#")[0]
        if not line and not fields:
            raise Stopped("writes no PBM")
        fields += line.split()
    return fields[1:]


def differ(one, other):
    """The number of pixels that two programs' PBMs differ in."""
    with subprocess.Popen(one, stdout=subprocess.PIPE) as a, subprocess.Popen(other, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as b:
        try:
            if (sizes := [rows(a.stdout), rows(b.stdout)])[0] != sizes[1]:
                return f"sizes {sizes}"
            pixels = 0
            while left := a.stdout.read(1 << 20):
                pixels += (int.from_bytes(left, "little") ^ int.from_bytes(b.stdout.read(len(left)), "little")).bit_count()
            return f"{pixels:,}"
        finally:
            a.kill()
            b.kill()


def table(title, commands, runs, against, compared, aims):
    """Runs named commands in turn, prints their medians and the ratios of `against`'s to ours, and says which aims ours, the first, reaches.

    An aim is how many times less wall time, processor time and memory than `against` at least (0: no aim), and the MiB at most.
    """
    print(f"{title}:\n")
    print(f"| program | wall s | CPU s | peak MiB | wall, CPU, memory of {against} in ours | differ |")
    print("|---|--:|--:|--:|--:|--:|")
    measured, stopped = {name: [] for name in commands}, {}
    for _ in range(runs):
        for name, command in commands.items():
            if name not in stopped:
                try:
                    measured[name].append(run(command))
                except Stopped as why:
                    stopped[name] = str(why)
    medians = {name: [statistics.median(column) for column in zip(*taken)] for name, taken in measured.items()}
    first = next(iter(commands))
    for name, command in commands.items():
        if name in stopped:
            print(f"| {name} | {stopped[name]} | | | | |")
            continue
        wall, cpu, kib, _ = medians[name]
        ratios = ""
        if name.startswith("runset") and against in medians and against not in stopped:
            ratios = ", ".join(f"{theirs / ours:.1f}" for theirs, ours in zip(medians[against][:3], [wall, cpu, kib]))
        past = " (past 4 GB)" if kib > KIB else ""
        pixels = differ(commands[first], command) if name in compared and name != first else ""
        print(f"| {name} | {wall:.3f} | {cpu:.3f} | {kib / 1024:,.1f}{past} | {ratios} | {pixels} |", flush=True)
    if first in stopped or against in stopped or against not in medians:
        return print()
    print()
    times = [theirs / ours for theirs, ours in zip(medians[against][:3], medians[first][:3])]
    for what, aim, measured in zip(["wall time", "CPU time", "memory"], aims, times):
        if aim:
            print(f"* {what}: {aim} times less than {against} is aimed at, {measured:.1f} measured: {'reached' if measured >= aim else 'missed'}")
    if len(aims) > 3:
        mib = medians[first][2] / 1024
        print(f"* memory: {aims[3]:.0f} MiB at most is aimed at, {mib:.1f} measured: {'reached' if mib <= aims[3] else 'missed'}")
    print(flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5, metavar="N")
    parser.add_argument("--folder", default=ROOT / "target/processes", type=pathlib.Path, metavar="DIR")
    parser.add_argument("tables", nargs="*", metavar="TABLE", help="pages, vertices, map, sheet; all of them if none is named")
    arguments = parser.parse_args()
    wanted = arguments.tables or ["pages", "vertices", "map", "sheet"]
    if unknown := set(wanted) - {"pages", "vertices", "map", "sheet"}:
        parser.error(f"no table {', '.join(sorted(unknown))}; there are pages, vertices, map, sheet")

    runset = build("build", "--release", "--bin", "runset")["runset"]
    plane = build("build", "--release", "--example", "plane")["plane"]
    peers = build("bench", "--no-run", "--bench", "peers")["peers"]
    found = {name: shutil.which(name) for name in ["gs", "mutool", "resvg"]}
    for name in [name for name, path in found.items() if not path]:
        print(f"not installed, skipped: {name}", file=sys.stderr)
    folder = arguments.folder
    names = {"pages": ["coast1e5", "manh1e5"], "vertices": ["coast1e6"], "map": ["map"], "sheet": ["sheet", "sheet-curves"]}
    for name in sum((names[name] for name in wanted), []):
        if not (folder / f"{name}.svg").exists():
            subprocess.run([plane, folder, name], check=True, stderr=subprocess.DEVNULL)

    def ours(file, *options):
        return [runset, "fill", folder / file, "--progress", "never", *options]

    def pdf(name, scale):
        resolution, file = str(72 * scale), folder / f"{name}.pdf"
        commands = {}
        if found["gs"]:
            device = ["-q", "-dNOPAUSE", "-dBATCH", "-dSAFER", "-sDEVICE=pbmraw", "-sOutputFile=-"]
            # By itself it paints every pixel that is touched; told to adjust by 0 px, those whose centre is inside.
            commands["Ghostscript"] = [found["gs"], *device, f"-r{resolution}", "-c", "0 0 .setfilladjust2", "-f", file]
        if found["mutool"]:
            # Level 9 is no anti-aliasing, and pixels whose centre is inside.
            commands["MuPDF"] = [found["mutool"], "draw", "-q", "-A", "9", "-B", "256", "-F", "pbm", "-o", "-", "-r", resolution, file]
        return commands

    said = lambda *command: subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout.strip()
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    versions = [f"{title} {said(path, '--version')}" for title, name in [("Ghostscript", "gs"), ("resvg", "resvg")] if (path := found[name])]
    print(f"{said('date', '-u', '+%-d %B %Y')}, commit {said('git', 'describe', '--always', '--dirty')}, {said('rustc', '--version')}; "
          f"{cpu}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.2f}; {', '.join(versions)}; "
          f"a program that does nothing peaks at {run(['true'])[2] / 1024:.1f} MiB here\n")

    if "pages" in wanted:
        # 40 MiB and 32 bytes for each of the 200,000 and 400,000 edges.
        limit = {"coast1e5": 46, "manh1e5": 52}
        for name in names["pages"]:
            options = ["--expr", "a - b", "--scale", "16", "--format", "pbm"]
            commands = {
                "runset, 2 threads, SVG": ours(f"{name}.svg", *options, "--threads", "2"),
                "runset, 2 threads, JSON": ours(f"{name}.json", *options, "--threads", "2"),
                "runset, 1 thread, SVG": ours(f"{name}.svg", *options, "--threads", "1"),
                **pdf(name, 16),
            }
            table(f"{name} at 65,536², to PBM in a pipe", commands, arguments.runs, "Ghostscript", set(commands), [3, 3, 0, limit[name]])

    if "vertices" in wanted:
        options = ["--expr", "a - b", "--scale", "4", "--format", "pbm"]
        library = lambda peer: [peers, "--svg", folder / "coast1e6.svg", "--with", peer, "--scale", "4"]
        commands = {
            "runset": ours("coast1e6.svg", *options),
            "runset, 1 thread": ours("coast1e6.svg", *options, "--threads", "1"),
            "usvg, only read": library("usvg"),
            "usvg, zeno": library("zeno"),
            "usvg, tiny-skia": library("tiny-skia"),
            "usvg, i_overlay, tiny-skia": library("i_overlay+tiny-skia"),
            **pdf("coast1e6", 4),
        }
        table("coast1e6 at 16,384², to PBM in a pipe", commands, arguments.runs, "usvg, zeno", set(commands) - {"usvg, only read"}, [2, 2, 0])

    if "map" in wanted:
        commands = {
            "runset, PPM": ours("map.svg", "--dpi", "600", "--format", "ppm"),
            "runset, PNG": ours("map.svg", "--dpi", "600", "--format", "png"),
        }
        if found["resvg"]:
            commands["resvg, PNG"] = [found["resvg"], "--dpi", "600", folder / "map.svg", "-c"]
        table("A map of 600,000 vertices on A0 at 600 dots an inch", commands, arguments.runs, "resvg, PNG", set(), [20, 20, 50])

    if "sheet" in wanted:
        for name, what in [("sheet", "of 24 straight edges"), ("sheet-curves", "of eight curves")]:
            into = folder / "sheet.tiff"
            sheet = lambda out, *options: ours(f"{name}.svg", "--dpi", "2400", "--format", "tiff", "--compression", "g4", "-o", out, *options)
            # Ghostscript's curves are flattened to within a pixel.
            commands = {
                "runset, 1 thread": sheet(into, "--threads", "1", "--tolerance", "1"),
                "runset, 2 threads": sheet(into, "--threads", "2", "--tolerance", "1"),
                "runset, 2 threads, into a pipe": sheet("-", "--threads", "2", "--tolerance", "1"),
                "runset, 2 threads, curves within 0.1 px": sheet(into, "--threads", "2"),
            }
            if found["gs"]:
                device = ["-q", "-dNOPAUSE", "-dBATCH", "-dSAFER", "-sDEVICE=tiffg4", f"-sOutputFile={folder / 'ghostscript.tiff'}", "-r2400"]
                commands["Ghostscript"] = [found["gs"], *device, "-c", "0 0 .setfilladjust2", "-f", folder / f"{name}.pdf"]
            title = f"5,000 opaque shapes {what} each on A0 at 2400 dots an inch, to TIFF in CCITT group 4"
            table(title, commands, arguments.runs, "Ghostscript", set(), [0, 1, 1])


if __name__ == "__main__":
    main()
