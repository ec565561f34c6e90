#!/usr/bin/env python3
"""Post a drawing to `runset serve` and draw it in the terminal while its lines arrive: client.py http://127.0.0.1:8080 poster.svg"""

import json
import sys
import urllib.request

service, path = sys.argv[1:]
document = open(path, "rb").read()
kind = "application/json" if document.lstrip().startswith(b"{") else "image/svg+xml"
request = urllib.request.Request(f"{service}/v1/fill?width=78&format=ndjson", document, {"Content-Type": kind})
with urllib.request.urlopen(request) as lines:
    header, end = json.loads(next(lines)), None
    for record in map(json.loads, lines):
        if "end" in record:
            end = record
            break
        row = [" "] * header["width"]
        for start, stop, *ink in record["runs"]:
            row[start:stop] = "#.o+=*-%"[ink[0] % 8 if ink else 0] * (stop - start)
        for y in range(record["y"], record["y"] + record["n"]):
            if y % 2 == 0:  # characters are twice as high as wide
                print("".join(row).rstrip(), flush=True)
if end is None or end["lines"] != header["height"]:
    sys.exit("the picture is not whole: its stream was cut")
