// A struct with a member of every kind that may be stored.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isthmus::store {

enum class Colour : std::uint8_t { red, green };

struct Inner {
  std::string name;
  std::vector<float> values;
  template <class F>
  void fields(F&& f) {
    f(name), f(values);
  }
  bool operator==(const Inner&) const = default;
};

struct Sample {
  bool flag = false;
  std::int32_t number = 0;
  double real = 0;
  Colour colour = Colour::red;
  std::string text;
  std::array<std::uint8_t, 3> bytes{};
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<Eigen::Vector3f> points;
  std::vector<Inner> inners;
  std::optional<Eigen::Isometry3d> perhaps;
  std::optional<double> perhaps_real;
  std::vector<std::pair<std::string, double>> named;
  template <class F>
  void fields(F&& f) {
    f(flag), f(number), f(real), f(colour), f(text), f(bytes), f(point), f(pose), f(information), f(points), f(inners);
    f(perhaps), f(perhaps_real), f(named);
  }
};

inline Sample full_sample() {
  Sample s;
  s.flag = true;
  s.number = -7;
  s.real = 1.0 / 3.0;
  s.colour = Colour::green;
  s.text = std::string("a\0b", 3);
  s.bytes = {1, 2, 255};
  s.point = {1, 2, 3};
  s.pose = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY());
  s.information.setRandom();
  s.points = {{1, 2, 3}, {4, 5, 6}};
  s.inners = {{"one", {1, 2}}, {"", {}}};
  s.perhaps = s.pose.inverse();
  s.named = {{"x", 1.5}, {"y", -2}};
  return s;
}

}  // namespace isthmus::store
