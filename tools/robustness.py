#!/usr/bin/env python3
"""How success falls when scans get worse: the method against Super4PCS on whole clouds.

  robustness.py run BENCH OUT.csv SETS... [--work DIR] [--seed N] [--min-overlap X] [--trials N] [--threads N]
      runs isthmus_bench for every level of noise, outliers and density; levels that OUT.csv already holds are kept
  robustness.py plot PICTURE.png TABLE.csv...
      draws the curves and prints the table for docs/robustness.md
"""
import argparse
import csv
import os
import pathlib
import subprocess
import tempfile

LEVELS = [("clean", 0.0), ("noise", 0.5), ("noise", 1.0), ("noise", 2.0), ("outliers", 0.1), ("outliers", 0.3),
          ("outliers", 0.5), ("density", 0.1), ("density", 0.3)]
ORDER = [0, 5, 2, 7, 6, 3, 4, 1, 8]  # the middle of each curve first, so that a run that is ended early shows the most
METHODS = {"default": "regions", "super4pcs on whole clouds": "super4pcs"}
FIELDS = ["set", "kind", "level", "method", "pairs", "right", "accepted", "wrong"]


def counts(rows):
    accepted = [r for r in rows if r["verdict"] == "accepted"]
    return {"pairs": len(rows), "right": sum(r["right"] == "1" for r in rows), "accepted": len(accepted),
            "wrong": sum(r["right"] == "0" for r in accepted)}


def name_of(place):
    return pathlib.Path(place.rsplit(":", 1)[0]).name


def run(args):
    done = []
    if os.path.exists(args.out):
        with open(args.out, newline="") as file:
            done = list(csv.DictReader(file))
    for place in args.sets:
        for kind, level in [LEVELS[k] for k in args.levels or ORDER]:
            if any(r["set"] == name_of(place) and r["kind"] == kind and float(r["level"]) == level for r in done):
                continue
            with tempfile.TemporaryDirectory() as tables:
                command = [args.bench, place, "--work", args.work, "--csv", tables, "--seed", str(args.seed), "--threads",
                           str(args.threads), "--min-overlap", str(args.min_overlap), "--whole-clouds", "--whole-trials",
                           str(args.trials)]
                if kind != "clean":
                    command += [f"--{kind}", str(level)]
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
                for table, method in METHODS.items():
                    with open(pathlib.Path(tables) / f"{table}.csv", newline="") as file:
                        rows = list(csv.DictReader(file))
                    done.append({"set": name_of(place), "kind": kind, "level": level, "method": method, **counts(rows)})
            temporary = args.out + ".new"
            with open(temporary, "w", newline="") as file:
                writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
                writer.writeheader()
                writer.writerows(done)
            os.replace(temporary, args.out)


def label_of(kind, level):
    return {"clean": "as measured", "noise": f"noise {level:g} voxels", "outliers": f"outliers {100 * level:.0f} %",
            "density": f"density 1 : {1 / level:.0f}" if level else ""}[kind]


def plot(args):
    rows = []
    for table in args.tables:
        with open(table, newline="") as file:
            rows += list(csv.DictReader(file))
    sets = list(dict.fromkeys(r["set"] for r in rows))
    found = {(r["set"], r["kind"], float(r["level"]), r["method"]): r for r in rows}
    print("| | " + " | ".join(f"{s}: regions | Super4PCS" for s in sets) + " |")
    print("|---|" + "---|" * (2 * len(sets)))
    for kind, level in LEVELS:
        cells = []
        for name in sets:
            for method in ("regions", "super4pcs"):
                r = found.get((name, kind, level, method))
                cells.append("" if r is None else f"{r['right']}/{r['pairs']}" + (
                    f" ({r['accepted']} accepted, {r['wrong']} wrongly)" if method == "regions" else ""))
        if any(cells):
            print(f"| {label_of(kind, level)} | " + " | ".join(cells) + " |")

    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    axes_of = {"noise": "noise, evaluation voxels", "outliers": "outliers, share of all points",
               "density": "density of one scan, share of the other's"}
    figure, axes = plt.subplots(len(sets), 3, figsize=(10, 2.4 * len(sets)), sharey=True, squeeze=False)
    for row, name in zip(axes, sets):
        for axis, (kind, title) in zip(row, axes_of.items()):
            for method, style in (("regions", "o-"), ("super4pcs", "s--")):
                points = [(lv, found[(name, k, lv, method)]) for k, lv in LEVELS
                          if k == kind and (name, k, lv, method) in found]
                clean = found.get((name, "clean", 0.0, method))
                if clean and kind == "density":
                    points.append((1.0, clean))
                elif clean:
                    points.insert(0, (0.0, clean))
                points.sort(key=lambda p: p[0])
                axis.plot([p[0] for p in points], [100 * int(p[1]["right"]) / max(int(p[1]["pairs"]), 1) for p in points],
                          style, label={"regions": "feature regions", "super4pcs": "Super4PCS, whole clouds"}[method])
            axis.set_ylim(-4, 104)
            axis.grid(alpha=0.3)
            if kind == "density":
                axis.set_xscale("log")
            if name == sets[-1]:
                axis.set_xlabel(title)
        row[0].set_ylabel(f"{name}\nright, %")
    axes[0][0].legend(loc="lower left", fontsize=8)
    figure.tight_layout()
    figure.savefig(args.picture, dpi=110, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("run")
    one.add_argument("bench")
    one.add_argument("out")
    one.add_argument("sets", nargs="+")
    one.add_argument("--work", default="bench")
    one.add_argument("--seed", type=int, default=5)
    one.add_argument("--min-overlap", type=float, default=0.1)
    one.add_argument("--trials", type=int, default=256)
    one.add_argument("--threads", type=int, default=1)
    one.add_argument("--levels", type=int, nargs="*", help="indices into LEVELS, all if not given")
    two = commands.add_parser("plot")
    two.add_argument("picture")
    two.add_argument("tables", nargs="+")
    args = parser.parse_args()
    run(args) if args.command == "run" else plot(args)


if __name__ == "__main__":
    main()
