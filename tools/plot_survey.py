#!/usr/bin/env python3
"""Draws a survey from above, before and after: plot_survey.py SCANS OUT PICTURE.png [--slice LOW HIGH]

Left, the scans as they lie in their files; right, as poses.txt of OUT places them (largest component), with stations and
accepted links. Only points whose height in the anchor's frame is in the slice are drawn (metres, default -0.5 0.5: what
levelled scanners see at the height of the instrument). Reads binary little endian PLY, as 'isthmus simulate' writes it.
"""
import argparse
import csv
import pathlib
import urllib.parse

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

TYPES = {"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8", "uchar": "u1", "uint8": "u1",
         "ushort": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4"}


def read_ply(path):
    """N x 3, metres, in the scan's own frame."""
    with open(path, "rb") as file:
        fields, count = [], 0
        for line in iter(file.readline, b"end_header\n"):
            words = line.decode().split()
            if not words:
                raise SystemExit(f"{path}: the header does not end")
            if words[0] == "format" and words[1] != "binary_little_endian":
                raise SystemExit(f"{path}: only binary little endian PLY can be drawn")
            if words[0] == "element" and words[1] == "vertex":
                count = int(words[2])
            if words[0] == "property":
                fields.append((words[2], TYPES[words[1]]))
        points = np.fromfile(file, dtype=fields, count=count)
    return np.stack([points["x"], points["y"], points["z"]], axis=1).astype(float)


def along_the_sheet(stations):
    """2 x 2 rotation that lays the longest direction of the stations along x."""
    centred = stations - stations.mean(axis=0)
    x = np.linalg.svd(centred)[2][0]
    return np.array([x, [-x[1], x[0]]])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("scans", type=pathlib.Path)
    arguments.add_argument("out", type=pathlib.Path)
    arguments.add_argument("picture")
    arguments.add_argument("--slice", nargs=2, type=float, default=(-0.5, 0.5), metavar=("LOW", "HIGH"))
    args = arguments.parse_args()

    rows = list(csv.DictReader(open(args.out / "scans.csv", newline="")))
    poses = {}
    for line in open(args.out / "poses.txt"):
        name, *numbers = line.split()
        poses[name] = np.array(numbers, float).reshape(3, 4)
    placed = [row for row in rows if row["component"] == "0"]
    names = {row["id"]: row["name"] for row in placed}

    stations = {id: poses[name][:2, 3] for id, name in names.items()}
    level = along_the_sheet(np.array(list(stations.values())))
    figure, (before, after) = plt.subplots(1, 2, figsize=(14, 5.2), dpi=100, width_ratios=(2, 3))
    colours = plt.get_cmap("tab10").colors
    drawn = {before: [], after: []}
    for k, row in enumerate(placed):
        points = read_ply(args.scans / urllib.parse.unquote(row["name"]))
        pose = poses[row["name"]]
        in_anchor = points @ pose[:, :3].T + pose[:, 3]
        inside = (in_anchor[:, 2] > args.slice[0]) & (in_anchor[:, 2] < args.slice[1])
        for axes, xy in ((before, points[inside, :2]), (after, in_anchor[inside, :2] @ level.T)):
            axes.plot(xy[:, 0], xy[:, 1], ",", color=colours[k % len(colours)], alpha=0.5)
            drawn[axes].append(xy)
    for link in csv.DictReader(open(args.out / "links.csv", newline="")):
        if link["verdict"] == "accepted" and link["source"] in stations and link["target"] in stations:
            ends = np.array([stations[link["source"]], stations[link["target"]]]) @ level.T
            after.plot(ends[:, 0], ends[:, 1], color="black", linewidth=1.2)
    for xy in stations.values():
        after.plot(*(level @ xy), "o", color="white", markeredgecolor="black", markersize=7)
    before.set_title(f"in: {len(placed)} scans, each in its own frame")
    after.set_title("out: one frame, stations, accepted links")
    for axes, parts in drawn.items():  # what is seen far away through windows need not be on the sheet
        low, high = np.percentile(np.concatenate(parts), (1, 99), axis=0)
        margin = 0.04 * max(high - low)
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)
    for axes in (before, after):
        axes.set_aspect("equal")
        axes.set_xlabel("metres")
    figure.tight_layout()
    figure.savefig(args.picture)


if __name__ == "__main__":
    main()
