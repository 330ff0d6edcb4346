#!/usr/bin/env python3
"""Whole runs of `snapfit flex` on grids of the sizes of PF's Table I, as the table of flex.md.

    cargo build --release && python3 benches/flex.py [--path safe] [--limit SECONDS] [BODIES …]

Times are user CPU seconds of the whole process: reading, programs, certificates, verifier.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile

# Rigid bodies: iterations and seconds (Gurobi, 2018), PF Table I.
PAPER = {
    36: (5, 0.358), 50: (8, 0.363), 90: (7, 1.621), 153: (8, 1.866),
    223: (5, 2.987), 332: (5, 2.761), 392: (8, 10.649), 396: (4, 2.002),
    688: (4, 5.951), 1703: (14, 233.341), 2497: (7, 166.582),
}


def cpu():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def main():
    parse = argparse.ArgumentParser(description=__doc__)
    parse.add_argument("bodies", nargs="*", type=int, default=list(PAPER))
    parse.add_argument("--snapfit", default="target/release/snapfit")
    parse.add_argument("--family", default="grid")
    parse.add_argument("--path", default="fast", choices=["fast", "safe"])
    parse.add_argument("--limit", type=float, default=600, help="wall-clock seconds a run")
    args = parse.parse_args()
    print("| bodies | program | steps (PF) | user s (PF) | ratio | exact pivots, by step "
          "| outcome | verified | displacement |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for bodies in args.bodies:
        with tempfile.NamedTemporaryFile(suffix=".toml") as file:
            make = [args.snapfit, "generate", args.family, "--bodies", str(bodies)]
            file.write(subprocess.run(make, check=True, capture_output=True).stdout)
            file.flush()
            begin = cpu()
            run = subprocess.run(
                [args.snapfit, "flex", file.name, "--path", args.path,
                 "--time-limit", str(args.limit)],
                capture_output=True, text=True)
            seconds = cpu() - begin
        if not run.stdout:
            print(f"| {bodies} | {run.stderr.strip()} |")
            continue
        d = json.loads(run.stdout)
        pivots = ", ".join(str(s["exact_pivots"]) for s in d["steps"])
        paper = PAPER.get(bodies)
        ratio = f"{seconds / paper[1]:.2f}" if paper else ""
        steps, time = paper or ("", "")
        print(f"| {bodies} | {d['rows']} × {d['columns']} | {d['iterations']} ({steps}) "
              f"| {seconds:.2f} ({time}) | {ratio} | {pivots} | {d['outcome']} "
              f"| {d['certificate']['verified']} | {d['displacement']['value']:.6g} |")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
