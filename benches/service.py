#!/usr/bin/env python3
"""Small answers of the service under load: prints a table of requests a second and their times.

    benches/service.py [--seconds N] [--connections N]

Needs Linux, cargo, Python 3.10 and wrk (Debian: wrk). The service, release build, and wrk share the machine: wrk has one thread and 8 connections, each asking again as soon as it has its
answer. N seconds a row (default 10).
"""

import argparse
import datetime
import http.client
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
POSTER = ROOT / "examples/art/poster.svg"
UNITS = {"us": 1e-3, "ms": 1.0, "s": 1e3}
# Asks for one picture again and again, or for a new one each time: then the document has to be prepared anew.
POST = """
local body = io.open("%s"):read("a")
local n = 0
request = function()
  n = n + 1
  local text = %s and body .. "<!-- " .. n .. " -->" or body
  return wrk.format("POST", "/v1/fill?width=512&format=%s", {["Content-Type"] = "image/svg+xml"}, text)
end
"""


def said(*command):
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()


def milliseconds(text):
    number, unit = re.fullmatch(r"([\d.]+)(us|ms|s)", text).groups()
    return float(number) * UNITS[unit]


def wrk(arguments, address, script=None):
    """Requests a second, and p50, p99 and the most in milliseconds; every answer has to be a good one."""
    command = ["wrk", "-t1", f"-c{arguments.connections}", f"-d{arguments.seconds}s", "--latency"]
    report = said(*command, *(["-s", script] if script else []), address)
    if "Non-2xx" in report or "Socket errors" in report:
        sys.exit(report)
    times = {share: milliseconds(time) for share, time in re.findall(r"^\s+(50|99)%\s+(\S+)", report, re.MULTILINE)}
    most = milliseconds(re.search(r"Latency(?:\s+\S+){2}\s+(\S+)", report).group(1))
    return float(re.search(r"Requests/sec:\s+([\d.]+)", report).group(1)), times["50"], times["99"], most


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=10, metavar="N")
    parser.add_argument("--connections", type=int, default=8, metavar="N")
    arguments = parser.parse_args()
    if not shutil.which("wrk"):
        sys.exit("wrk is not installed (Debian: wrk)")
    subprocess.run(["cargo", "build", "--quiet", "--release", "--bin", "runset"], cwd=ROOT, check=True)
    runset = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/runset"
    with tempfile.TemporaryDirectory() as folder:
        command = [runset, "serve", "--addr", "127.0.0.1:0", "--data", f"{folder}/data", "--log", "warn"]
        service = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        try:
            address = re.search(r"http://[^,]+", service.stderr.readline()).group()
            connection = http.client.HTTPConnection(address.removeprefix("http://"))
            connection.request("POST", "/v1/jobs?width=512&format=pbm", POSTER.read_bytes(), {"Content-Type": "image/svg+xml"})
            job = connection.getresponse().getheader("location")
            rows = [
                ("`POST /v1/fill`, the poster in 512 px, to PNG", "false", "png"),
                ("the same, to ndjson", "false", "ndjson"),
                ("the same to PNG, each time another document", "true", "png"),
            ]
            commit = said("git", "describe", "--always", "--dirty")
            load = f"{os.getloadavg()[0]:.2f}"
            today = datetime.date.today()
            print(f"{today.day} {today:%B %Y}, commit {commit}, {said('rustc', '--version').split(' (')[0]}; "
                  f"{os.cpu_count()} cores, {platform.system()}, load {load} before; wrk, {arguments.connections} connections, {arguments.seconds} s a row\n")
            print("| request | requests/s | p50 ms | p99 ms | most ms |\n|---|--:|--:|--:|--:|")
            for name, anew, form in rows:
                script = pathlib.Path(folder) / "post.lua"
                script.write_text(POST % (POSTER, anew, form))
                print("| {} | {:,.0f} | {:.2f} | {:.2f} | {:.1f} |".format(name, *wrk(arguments, address, script)), flush=True)
            print("| `GET` of a job's raster, 512 px, PBM | {:,.0f} | {:.2f} | {:.2f} | {:.1f} |".format(*wrk(arguments, f"{address}{job}/raster")))
            print("| `GET /healthz` | {:,.0f} | {:.2f} | {:.2f} | {:.1f} |".format(*wrk(arguments, f"{address}/healthz")))
        finally:
            service.terminate()
            service.wait()


main()
