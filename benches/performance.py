#!/usr/bin/env python3
"""Renews the figures of docs/performance.md: runs the command that stands before each of its tables, and puts in what it prints.

    benches/performance.py [WORD]

With WORD only those commands are run that contain it: peers, paper, processes, service, solid. They take some ten minutes together on a quiet machine.
"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/performance.md"
MEASURED = re.compile(r"(<!-- measured by: (.+?) -->\n).*?(<!-- end -->\n)", re.DOTALL)


def renew(match):
    before, command, after = match.groups()
    if len(sys.argv) > 1 and sys.argv[1] not in command:
        return match.group()
    print(command, file=sys.stderr)
    said = subprocess.run(command, shell=True, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return f"{before}\n{said.strip()}\n\n{after}"


if len(sys.argv) > 1 and sys.argv[1].startswith("-"):
    print(__doc__.strip())
else:
    PAGE.write_text(MEASURED.sub(renew, PAGE.read_text()))
