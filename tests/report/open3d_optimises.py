"""Optimises a pose graph with Open3D and says how far the poses moved, in metres. Exit code 77: no Open3D here.

Arguments: the graph (JSON), the node that is held, and how far every other node is put off before, in metres."""
import sys

try:
    import numpy
    import open3d
except ImportError as error:
    print(error)
    sys.exit(77)

registration = open3d.pipelines.registration
path, held, off_m = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
graph = open3d.io.read_pose_graph(path)
before = [numpy.array(node.pose) for node in graph.nodes]
random = numpy.random.RandomState(1)
for k, node in enumerate(graph.nodes):
    if k == held:
        continue
    pose = numpy.array(node.pose)
    pose[:3, 3] += off_m * random.normal(size=3)
    node.pose = pose
criteria = registration.GlobalOptimizationConvergenceCriteria()
criteria.max_iteration = 500
criteria.min_relative_increment = criteria.min_relative_residual_increment = criteria.min_residual = 0.0
criteria.min_right_term = 1e-9
option = registration.GlobalOptimizationOption(
    max_correspondence_distance=1.0, edge_prune_threshold=0.0, preference_loop_closure=1.0, reference_node=held)
registration.global_optimization(graph, registration.GlobalOptimizationLevenbergMarquardt(), criteria, option)
after = [numpy.array(node.pose) for node in graph.nodes]
to_before = before[held] @ numpy.linalg.inv(after[held])
print(max(numpy.linalg.norm((to_before @ a)[:3, 3] - b[:3, 3]) for a, b in zip(after, before)))
