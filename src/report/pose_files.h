// poses.txt and pose_graph.g2o; conventions in docs/outputs.md.
#pragma once

#include <string>

#include "report/survey_record.h"

namespace isthmus::report {

/// "name r00 r01 r02 tx r10 ... tz" per placed scan: scan -> frame of its component (its anchor's scan frame), metres.
std::string poses_text(const SurveyRecord& record);

/// VERTEX_SE3:QUAT per placed scan, EDGE_SE3:QUAT target source per accepted link.
std::string pose_graph_g2o(const SurveyRecord& record);

/// Information for g2o's error vector (translation, vector part of the unit quaternion) from the information for a
/// right perturbation (translation, rotation vector). The vector part is half the rotation vector to first order, so
/// the rotation block weighs four times as much and the cross blocks twice.
Matrix6d g2o_information(const Matrix6d& information);

}  // namespace isthmus::report
