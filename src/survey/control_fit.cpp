#include "survey/control_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "survey/optimise.h"

namespace isthmus::survey {
namespace {

// 99.9 % of chi-square distributions with 2, 3 and 6 degrees of freedom.
constexpr double kLimitLevelled = 13.82, kLimitPoint = 16.27, kLimitPose = 22.46;
constexpr std::size_t kMaxCandidates = 4000;
// Points closer to one line than this many of their uncertainties do not fix the turn about it.
constexpr double kOffLineSigmas = 5.0;
constexpr int kRefits = 5;

double limit_of(ControlKind kind) {
  return kind == ControlKind::levelled ? kLimitLevelled : kind == ControlKind::point ? kLimitPoint : kLimitPose;
}

double deg(double rad) { return rad * 180.0 / std::numbers::pi; }

/// A term as seen from the root: what the rigid fit works on.
struct RigidTerm {
  const ControlTerm* term = nullptr;
  Transform root_from_node = Transform::Identity();
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Ones();  ///< the survey's own uncertainty included
  double sigma_rad = 1;
};

std::vector<RigidTerm> rigid_terms(const ControlledPart& part) {
  std::vector<RigidTerm> out;
  for (const ControlTerm& term : part.terms) {
    const auto node = static_cast<std::size_t>(term.node);
    const double lever_m = part.sigma_rad[node] * term.p_in_node.norm();
    const double own_sq = part.sigma_m[node] * part.sigma_m[node] + lever_m * lever_m;
    out.push_back({&term, part.root_from_node[node], (term.sigma_m.cwiseAbs2().array() + own_sq).sqrt().matrix(),
                   std::hypot(term.sigma_rad, part.sigma_rad[node])});
  }
  return out;
}

/// Whitened error (up to six numbers) of a term when the part stands at shifted_from_root.
Vector6d whitened(const RigidTerm& t, const Transform& shifted_from_root) {
  const Transform pose = shifted_from_root * t.root_from_node;
  Vector6d e = Vector6d::Zero();
  const ControlTerm& term = *t.term;
  if (term.kind == ControlKind::point) {
    e.head<3>() = (pose * term.p_in_node - term.p_in_shifted).cwiseQuotient(t.sigma_m);
  } else if (term.kind == ControlKind::levelled) {
    e.head<2>() = pose.linear().col(2).head<2>() / t.sigma_rad;
    if (pose.linear()(2, 2) < 0) e[2] = 10 / t.sigma_rad;  // upside down
  } else {
    e.head<3>() = (pose.translation() - term.shifted_from_node.translation()).cwiseQuotient(t.sigma_m);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(term.shifted_from_node.linear().transpose() * pose.linear()));
    e.tail<3>() = turn.angle() * turn.axis() / t.sigma_rad;
  }
  return e;
}

std::vector<char> inliers_at(const std::vector<RigidTerm>& terms, const Transform& t) {
  std::vector<char> in;
  for (const RigidTerm& term : terms) in.push_back(whitened(term, t).squaredNorm() <= limit_of(term.term->kind));
  return in;
}

double cost_at(const std::vector<RigidTerm>& terms, const Transform& t) {
  double cost = 0;
  for (const RigidTerm& term : terms)
    cost += std::min(1.0, whitened(term, t).squaredNorm() / limit_of(term.term->kind));
  return cost;
}

Transform moved(const Transform& t, const Vector6d& step, const Eigen::Vector3d& pivot) {
  Transform d = Transform::Identity();
  d.linear() = rotation_from_vector(step.tail<3>());
  return Eigen::Translation3d(pivot + step.head<3>()) * d * Eigen::Translation3d(-pivot) * t;
}

/// Gauss-Newton on the inliers; a weak prior holds what they leave open.
Transform refit(const std::vector<RigidTerm>& terms, const std::vector<char>& in, Transform t) {
  constexpr double kStep = 1e-6, kPrior = 1e-9;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  for (const RigidTerm& term : terms)
    pivot += (t * term.root_from_node).translation() / static_cast<double>(terms.size());
  for (int turn = 0; turn < kRefits; ++turn) {
    Matrix6d normal = kPrior * Matrix6d::Identity();
    Vector6d right = Vector6d::Zero();
    for (std::size_t k = 0; k < terms.size(); ++k) {
      if (!in[k]) continue;
      Matrix6d jacobian;
      for (int c = 0; c < 6; ++c) {
        const Vector6d step = kStep * Vector6d::Unit(c);
        jacobian.col(c) =
            (whitened(terms[k], moved(t, step, pivot)) - whitened(terms[k], moved(t, -step, pivot))) / (2 * kStep);
      }
      normal += jacobian.transpose() * jacobian;
      right -= jacobian.transpose() * whitened(terms[k], t);
    }
    t = moved(t, normal.ldlt().solve(right), pivot);
  }
  return orthonormalised(t);
}

Eigen::Vector3d in_root(const RigidTerm& t) { return t.root_from_node * t.term->p_in_node; }

/// Whether the points of these terms are off one line by more than their uncertainty.
bool spread_in_plane(const std::vector<RigidTerm>& terms, const std::vector<int>& points) {
  if (points.size() < 3) return false;
  Eigen::MatrixXd m(3, static_cast<Eigen::Index>(points.size()));
  double sigma = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const RigidTerm& t = terms[static_cast<std::size_t>(points[k])];
    m.col(static_cast<Eigen::Index>(k)) = in_root(t);
    sigma = std::max(sigma, t.sigma_m.maxCoeff());
  }
  m.colwise() -= Eigen::Vector3d(m.rowwise().mean());
  return Eigen::JacobiSVD<Eigen::MatrixXd>(m).singularValues()[1] > kOffLineSigmas * sigma;
}

Transform fit_points(const std::vector<RigidTerm>& terms, const std::vector<int>& points) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const RigidTerm& t = terms[static_cast<std::size_t>(points[static_cast<std::size_t>(k)])];
    from.col(k) = in_root(t), to.col(k) = t.term->p_in_shifted;
  }
  Transform out = Transform::Identity();
  out.matrix() = Eigen::umeyama(from, to, false);
  return out;
}

/// The least turn that makes a level scan level, about the anchor.
Transform level(const RigidTerm& t, const Transform& root_from_anchor) {
  Transform out = Transform::Identity();
  out.linear() =
      Eigen::Quaterniond::FromTwoVectors(t.root_from_node.linear().col(2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d anchor = root_from_anchor.translation();
  return Eigen::Translation3d(anchor) * out * Eigen::Translation3d(-anchor);
}

/// Two points and up: turn about the vertical so that the horizontal directions meet, middle onto middle.
std::optional<Transform> fit_level_pair(const RigidTerm& up, const RigidTerm& a, const RigidTerm& b) {
  const Transform flat = level(up, Transform::Identity());
  const Eigen::Vector3d pa = flat * in_root(a), pb = flat * in_root(b);
  const Eigen::Vector3d from = pb - pa, to = b.term->p_in_shifted - a.term->p_in_shifted;
  const double sigma = std::max(a.sigma_m.maxCoeff(), b.sigma_m.maxCoeff());
  if (std::min(from.head<2>().norm(), to.head<2>().norm()) <= kOffLineSigmas * sigma) return std::nullopt;
  const double angle = std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x());
  Transform turn = Transform::Identity();
  turn.linear() = rotation_from_vector({0, 0, angle});
  const Eigen::Vector3d middle = 0.5 * (a.term->p_in_shifted + b.term->p_in_shifted);
  return Eigen::Translation3d(middle) * turn * Eigen::Translation3d(-0.5 * (pa + pb)) * flat;
}

std::vector<int> of_kind(const std::vector<RigidTerm>& terms, ControlKind kind) {
  std::vector<int> out;
  for (std::size_t k = 0; k < terms.size(); ++k)
    if (terms[k].term->kind == kind) out.push_back(static_cast<int>(k));
  return out;
}

std::vector<Transform> candidates_of(const std::vector<RigidTerm>& terms, const Transform& root_from_anchor) {
  const std::vector<int> points = of_kind(terms, ControlKind::point), poses = of_kind(terms, ControlKind::pose),
                         levelled = of_kind(terms, ControlKind::levelled);
  const auto at = [&](int k) -> const RigidTerm& { return terms[static_cast<std::size_t>(k)]; };
  std::vector<Transform> out;
  for (const int k : poses) out.push_back(at(k).term->shifted_from_node * at(k).root_from_node.inverse());
  const std::size_t n = points.size();
  const std::size_t num_triples = n < 3 ? 0 : n * (n - 1) * (n - 2) / 6;
  const std::size_t stride = num_triples / kMaxCandidates + 1;
  std::size_t number = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t c = b + 1; c < n; ++c) {
        if (number++ % stride != 0) continue;
        const std::vector<int> triple = {points[a], points[b], points[c]};
        if (spread_in_plane(terms, triple)) out.push_back(fit_points(terms, triple));
      }
  if (!levelled.empty())
    for (std::size_t a = 0; a < n && out.size() < 2 * kMaxCandidates; ++a)
      for (std::size_t b = a + 1; b < n; ++b)
        for (const int up : {levelled.front(), levelled.back()})
          if (const auto t = fit_level_pair(at(up), at(points[a]), at(points[b]))) out.push_back(*t);
  if (points.empty() && poses.empty())
    for (const int up : levelled) out.push_back(level(at(up), root_from_anchor));
  return out;
}

int count_of(const std::vector<char>& in) { return static_cast<int>(std::count(in.begin(), in.end(), 1)); }

/// Whether what is left fixes the part in the world, with something to spare if something was refused.
std::string open_question(const std::vector<RigidTerm>& terms, const std::vector<char>& in) {
  std::vector<int> points;
  int poses = 0, levelled = 0, placing = 0, refused = 0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const ControlKind kind = terms[k].term->kind;
    if (kind != ControlKind::levelled) ++placing, refused += !in[k];
    if (!in[k]) continue;
    if (kind == ControlKind::point) points.push_back(static_cast<int>(k));
    poses += kind == ControlKind::pose;
    levelled += kind == ControlKind::levelled;
  }
  if (placing == 0)
    return 2 * levelled > static_cast<int>(terms.size()) ? "" : "the levelled scans contradict each other";
  const int spare = static_cast<int>(points.size()) + 3 * poses - (levelled > 0 ? 2 : 3);
  if (refused > 0 && spare < 1)
    return "the control contradicts itself or the survey, and nothing tells which item is wrong";
  if (poses > 0 || spread_in_plane(terms, points) || (levelled > 0 && points.size() >= 2)) return "";
  return "it takes three points that are not in one line, two points and a levelled scan, or a pose";
}

std::string refusal(const ControlTerm& term, const Transform& pose) {
  const ControlMiss miss = miss_of(term, pose);
  if (term.kind == ControlKind::levelled)
    return fmt::format("tilts by {:.3g} deg against the others", deg(miss.angle_rad));
  if (term.kind == ControlKind::point) return fmt::format("{:.3g} m off where the others put it", miss.d_m.norm());
  return fmt::format("{:.3g} m and {:.3g} deg off where the others put it", miss.d_m.norm(), deg(miss.angle_rad));
}

}  // namespace

ControlMiss miss_of(const ControlTerm& term, const Transform& shifted_from_node) {
  ControlMiss miss;
  if (term.kind == ControlKind::point) miss.d_m = shifted_from_node * term.p_in_node - term.p_in_shifted;
  if (term.kind == ControlKind::levelled)
    miss.angle_rad = std::atan2(shifted_from_node.linear().col(2).head<2>().norm(), shifted_from_node.linear()(2, 2));
  if (term.kind == ControlKind::pose) {
    miss.d_m = shifted_from_node.translation() - term.shifted_from_node.translation();
    miss.angle_rad = rotation_angle_rad(term.shifted_from_node.linear().transpose() * shifted_from_node.linear());
  }
  return miss;
}

ControlFit fit_control(const ControlledPart& part) {
  ControlFit fit;
  fit.refused.resize(part.terms.size());
  const std::vector<RigidTerm> terms = rigid_terms(part);
  const Transform root_from_anchor = part.root_from_node[static_cast<std::size_t>(part.anchor)];
  const std::vector<Transform> candidates = candidates_of(terms, root_from_anchor);
  const auto give_up = [&](std::string why) {
    fit.problem = std::move(why);
    for (std::string& reason : fit.refused) reason = fit.problem;
    return fit;
  };
  if (candidates.empty()) return give_up(open_question(terms, std::vector<char>(terms.size(), 1)));
  const auto best = std::min_element(candidates.begin(), candidates.end(), [&](const Transform& a, const Transform& b) {
    return cost_at(terms, a) < cost_at(terms, b);
  });
  Transform rigid = *best;
  std::vector<char> in = inliers_at(terms, rigid);
  for (int turn = 0; turn < 2; ++turn) {
    rigid = refit(terms, in, rigid);
    in = inliers_at(terms, rigid);
  }
  if (const std::string question = open_question(terms, in); !question.empty()) return give_up(question);
  // Another place that as many agree on, and others.
  if (count_of(in) < static_cast<int>(terms.size()))
    for (const Transform& candidate : candidates) {
      const std::vector<char> other = inliers_at(terms, candidate);
      bool differs = false;
      for (std::size_t k = 0; k < other.size(); ++k) differs = differs || (other[k] && !in[k]);
      if (differs && count_of(other) >= count_of(in))
        return give_up("the control contradicts itself or the survey, and nothing tells which item is wrong");
    }
  fit.levelled_only = std::all_of(part.terms.begin(), part.terms.end(),
                                  [](const ControlTerm& t) { return t.kind == ControlKind::levelled; });
  std::vector<ControlTerm> used;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (in[k])
      used.push_back(part.terms[k]);
    else
      fit.refused[k] = refusal(part.terms[k], rigid * terms[k].root_from_node);
  }
  std::vector<Transform> start;
  for (const Transform& t : part.root_from_node) start.push_back(rigid * t);
  const OptimisedPoses solved =
      optimise_with_control(std::move(start), part.measurements, used, fit.levelled_only ? part.anchor : -1);
  if (!solved.problem.empty()) return give_up(solved.problem);
  fit.placed = true;
  fit.shifted_from_root = rigid;
  for (const int node : part.nodes)
    fit.shifted_from_node.push_back(solved.root_from_node[static_cast<std::size_t>(node)]);
  return fit;
}

}  // namespace isthmus::survey
