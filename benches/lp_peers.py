#!/usr/bin/env python3
"""Whole exact solves of linear programs beside their peers, as a Markdown table.

    python3 benches/lp_peers.py FILE.mps.gz... > benches/lp.md

Seconds are user CPU time of a whole process (reading, solving, writing), one process at a time; a
peer that is not installed leaves its column empty. Peers: `esolver` (QSopt_ex), `soplex` 9 with
its own `settings/exact.set` (SOPLEX_EXACT names the file), and HiGHS from `highspy` (float:
interior point with crossover, and its default; what its process takes to start is not counted,
while ours is). SNAPFIT names our binary, LIMIT the seconds
allowed each, SKIP peers to leave out, separated by commas.
"""
import gzip, json, math, os, resource, shutil, subprocess, sys, tempfile, time

SNAPFIT = os.environ.get("SNAPFIT", "target/release/snapfit")
LIMIT = float(os.environ.get("LIMIT", "300"))
SKIP = set(os.environ.get("SKIP", "").split(","))
EXACT = os.environ.get("SOPLEX_EXACT", "exact.set")
HIGHS = """
import sys, time, highspy
start = time.process_time()
h = highspy.Highs(); h.setOptionValue("output_flag", False); h.setOptionValue("threads", 1)
if sys.argv[2] == "ipm":
    h.setOptionValue("solver", "ipm"); h.setOptionValue("run_crossover", "on")
h.readModel(sys.argv[1]); h.run()
open(sys.argv[3], "w").write(str(time.process_time() - start))
"""


def run(command):
    """(exit status or None, user seconds, peak MiB) of one process."""
    with open(os.devnull, "w") as null:
        p = subprocess.Popen(command, stdout=null, stderr=null)
        end = time.time() + LIMIT
        while True:
            pid, status, usage = os.wait4(p.pid, os.WNOHANG)
            if pid:
                p.returncode = os.waitstatus_to_exitcode(status)
                return p.returncode, usage.ru_utime, usage.ru_maxrss / 1024
            if time.time() > end:
                p.kill()
                os.wait4(p.pid, 0)
                return None, LIMIT, 0
            time.sleep(0.002)


def main():
    with tempfile.TemporaryDirectory() as folder:
        plain, result = os.path.join(folder, "m.mps"), os.path.join(folder, "r.json")
        script, clock = os.path.join(folder, "h.py"), os.path.join(folder, "clock")
        open(script, "w").write(HIGHS)
        idle = run([sys.executable, "-c", "import highspy"])
        peers = {
            "QSopt_ex": ["esolver", plain] if shutil.which("esolver") else None,
            "SoPlex exact": ["soplex", "--loadset=" + EXACT, plain] if shutil.which("soplex") else None,
            "HiGHS IPM": [sys.executable, script, plain, "ipm", clock] if idle[0] == 0 else None,
            "HiGHS": [sys.executable, script, plain, "choose", clock] if idle[0] == 0 else None,
        }
        peers = {k: v for k, v in peers.items() if v and k not in SKIP}
        print("| instance | status | exact pivots | snapfit s | verify s | MiB | bounds s |", end="")
        print("".join(f" {k} s |" for k in peers))
        print("|---|---|" + "---|" * (5 + len(peers)))
        logs, late = {k: [] for k in peers}, []
        for path in sys.argv[1:]:
            name = os.path.basename(path).removesuffix(".gz").removesuffix(".mps")
            data = open(path, "rb").read()
            open(plain, "wb").write(gzip.decompress(data) if path.endswith(".gz") else data)
            limit = ["--time-limit", str(LIMIT)]
            code, ours, memory = run([SNAPFIT, "lp", plain, "--out", result] + limit)
            out = json.load(open(result)) if code in (0, 3) else {}
            proof, checking, _ = run([SNAPFIT, "verify", result])
            _, bounds, _ = run([SNAPFIT, "lp", plain, "--accuracy", "bounds", "--out", result] + limit)
            status = out.get("status", "failed") + ("" if proof == 0 else " UNPROVEN")
            row = f"| {name} | {status} | {out.get('exact_pivots')} | {ours:.3f} | {checking:.3f} | {memory:.0f} | {bounds:.3f} |"
            for k, command in peers.items():
                code, seconds, _ = run(command)
                if k.startswith("HiGHS") and code is not None:
                    seconds = float(open(clock).read())
                row += f" {'>' if code is None else ''}{seconds:.3f} |"
                logs[k].append(math.log(max(ours, 0.005) / max(seconds, 0.005)))
                if ours > 0.1 and ours > 5 * seconds and not k.startswith("HiGHS"):
                    late.append(f"{name} ({ours / max(seconds, 0.001):.1f} × {k})")
            print(row, flush=True)
        print()
        for k, v in logs.items():
            if v:
                print(f"Geometric mean of snapfit / {k} (times below 5 ms count as 5 ms): {math.exp(sum(v) / len(v)):.2f}.")
        print("Over 0.1 s and slower than 5 times an exact peer: " + (", ".join(late) or "none") + ".")


main()
