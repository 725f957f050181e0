// Links that a person takes out or adds.
#pragma once

#include "survey/pose_graph.h"

namespace isthmus {

/// Marks every link between two scans, whichever is the source, as taken out. Returns how many there were.
int take_out_links(PoseGraph& graph, int a, int b);

/// A link between scans of the graph as a person sees it: good to a voxel at the source's centre and, as a rotation, at
/// its radius. It takes part like a link that the pair stage accepted: loops may reject it.
/// `target_from_source` between local frames.
Link link_by_hand(const PoseGraph& graph, int source, int target, const Transform& target_from_source);

}  // namespace isthmus
