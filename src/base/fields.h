// Serialisation by field lists: a struct names its members once, stores and digests walk that list.
//
//   struct FeatureCloud { std::vector<Eigen::Vector3f> points; double voxel_m = 0;
//     template <class F> void fields(F&& f) { f(points); f(voxel_m); } };
//
// Allowed members: arithmetic types, std::pair of allowed members, enums, std::string, fixed-size Eigen matrices,
// Eigen::Isometry3d, std::optional and std::vector of allowed members, std::array of arithmetic types, and structs that
// have fields() themselves.
#pragma once
namespace isthmus {
template <class T>
concept HasFields = requires(T& t) {
  t.fields([](auto&) {});
};
}  // namespace isthmus
