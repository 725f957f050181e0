"""Open3D itself reads the exported pose graph: open3d_reads.py FOLDER with graph.json and poses.csv. 77: no Open3D."""
import csv
import sys

try:
    import numpy as np
    import open3d
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

folder = sys.argv[1]
graph = open3d.io.read_pose_graph(f"{folder}/graph.json")
with open(f"{folder}/poses.csv", newline="", encoding="utf-8") as file:
    rows = list(csv.reader(file))[1:]
poses = [np.array(row[1:], float).reshape(4, 4) for row in rows]
assert len(graph.nodes) == len(poses) > 0, (len(graph.nodes), len(poses))
for node, pose in zip(graph.nodes, poses):
    assert np.abs(node.pose - pose).max() < 1e-9
assert len(graph.edges) > 0
for edge in graph.edges:
    source, target = poses[edge.source_node_id], poses[edge.target_node_id]
    off = np.linalg.inv(edge.transformation) @ np.linalg.inv(target) @ source
    assert np.abs(off - np.eye(4)).max() < 0.2, off
    assert not edge.uncertain and np.linalg.eigvalsh(edge.information).min() > 0
print(f"Open3D {open3d.__version__}: {len(graph.nodes)} nodes, {len(graph.edges)} edges")
