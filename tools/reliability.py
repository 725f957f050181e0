#!/usr/bin/env python3
"""Is a stated probability the share that is right? reliability.py PICTURE.png TABLE.csv...

Reads tables of isthmus_bench --csv, prints the table and the expected calibration error (pairs-weighted mean distance between
mean stated probability and share right), and draws the reliability diagram. Pairs without any hypothesis count as stated 0 and
wrong.
"""
import csv
import sys

EDGES = [0.0, 0.05, 0.2, 0.5, 0.8, 0.97, 1.0]


def bins_of(pairs):
    """(low, high, pairs, mean stated, share right) of each bin that is not empty."""
    out = []
    for low, high in zip(EDGES, EDGES[1:]):
        inside = [p for p in pairs if low <= p[0] and (p[0] < high or high == 1.0)]
        if inside:
            out.append((low, high, len(inside), sum(p for p, _ in inside) / len(inside),
                        sum(right for _, right in inside) / len(inside)))
    return out


def calibration_error(bins):
    total = sum(b[2] for b in bins)
    return sum(b[2] * abs(b[3] - b[4]) for b in bins) / total if total else 0.0


def main():
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    pairs = []
    for table in sys.argv[2:]:
        with open(table, newline="") as file:
            pairs += [(float(r["probability"]), int(r["right"])) for r in csv.DictReader(file)]
    bins = bins_of(pairs)
    error = calibration_error(bins)
    print("| stated probability | pairs | mean stated | share right |\n|---|---|---|---|")
    for low, high, count, stated, right in bins:
        print(f"| {low:g}-{high:g} | {count} | {stated:.3f} | {right:.3f} |")
    print(f"\n{len(pairs)} pairs, expected calibration error {error:.3f}")

    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(4.6, 4.6))
    axis.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    for _, _, count, stated, right in bins:
        # Wilson's interval of the share, 95 %
        z = 1.96
        middle = (right + z * z / (2 * count)) / (1 + z * z / count)
        half = z / (1 + z * z / count) * (right * (1 - right) / count + z * z / (4 * count * count)) ** 0.5
        axis.plot([stated, stated], [middle - half, middle + half], color="C0", linewidth=1)
        axis.plot([stated], [right], "o", color="C0")
        axis.annotate(str(count), (stated, right), xytext=(5, -10), textcoords="offset points", fontsize=8)
    axis.set_xlabel("stated probability, mean of the bin")
    axis.set_ylabel("share right (bars: 95 %, numbers: pairs)")
    axis.set_title(f"{len(pairs)} pairs, expected calibration error {error:.3f}", fontsize=9)
    axis.set_xlim(-0.03, 1.03)
    axis.set_ylim(-0.03, 1.03)
    figure.tight_layout()
    figure.savefig(sys.argv[1], dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    main()
