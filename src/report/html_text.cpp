#include "report/html_text.h"

#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

namespace isthmus::report {
namespace {

// Finer towards certainty: 0.99 and 0.95 are far apart in the number of wrong links they let through.
constexpr std::array<double, kNumClasses - 1> kProbabilityBounds{0.99, 0.95, 0.9, 0.7};
constexpr std::array<const char*, kNumClasses> kProbabilityTexts{"≥ 0.99", "0.95 – 0.99", "0.9 – 0.95", "0.7 – 0.9",
                                                                 "< 0.7"};
// In voxels: a residual near half a voxel says no more than the sampling does.
constexpr std::array<double, kNumClasses - 1> kResidualBounds{0.1, 0.2, 0.3, 0.5};
constexpr std::array<const char*, kNumClasses> kResidualTexts{"≤ 0.1 voxel", "0.1 – 0.2", "0.2 – 0.3", "0.3 – 0.5",
                                                              "> 0.5 voxel"};

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string metres(double value) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  if (size < 0.001) return fmt::format("{:.2f} mm", value * 1e3);
  if (size < 0.01) return fmt::format("{:.1f} mm", value * 1e3);
  if (size < 0.3) return fmt::format("{:.0f} mm", value * 1e3);
  if (size < 100) return fmt::format("{:.2f} m", value);
  return fmt::format("{:.0f} m", value);
}

std::string degrees(double radians) {
  const double deg = radians * 180.0 / std::numbers::pi;
  return deg < 1 ? fmt::format("{:.3f}°", deg) : fmt::format("{:.1f}°", deg);
}

std::string percent(double share) {
  return share < 0.0995 ? fmt::format("{:.1f} %", share * 100.0) : fmt::format("{:.0f} %", share * 100.0);
}

std::string large_number(std::uint64_t n) {
  if (n >= 1000000000) return fmt::format("{:.2f} billion", static_cast<double>(n) * 1e-9);
  if (n >= 1000000) return fmt::format("{:.2f} million", static_cast<double>(n) * 1e-6);
  return n < 1000 ? fmt::format("{}", n) : fmt::format("{} {:03}", n / 1000, n % 1000);
}

std::string duration(double seconds) {
  if (seconds < 10) return fmt::format("{:.2g} s", seconds);
  const long long whole = std::llround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string counted(int n, std::string_view noun) { return fmt::format("{} {}{}", n, noun, n == 1 ? "" : "s"); }

std::string short_name(const std::string& name, std::size_t max_length) {
  std::string text = name.substr(name.rfind('/') == std::string::npos ? 0 : name.rfind('/') + 1);
  const std::size_t dot = text.rfind('.');
  const std::size_t part = text.find('#', dot == std::string::npos ? 0 : dot);  // "site.ptx#2": the number stays
  if (dot != std::string::npos && dot > 0)
    text = text.substr(0, dot) + (part == std::string::npos ? std::string() : text.substr(part));
  if (text.size() <= max_length) return text;
  const std::size_t tail = max_length / 2;
  return text.substr(0, max_length - tail - 1) + "…" + text.substr(text.size() - tail);
}

int probability_class(double probability) {
  int c = 0;
  while (c < kNumClasses - 1 && probability < kProbabilityBounds[c]) ++c;
  return c;
}

int residual_class(double rms_m, double voxel_m) {
  int c = 0;
  while (c < kNumClasses - 1 && rms_m > kResidualBounds[c] * voxel_m) ++c;
  return c;
}

const char* probability_bound(int c) { return kProbabilityTexts[c]; }
const char* residual_bound(int c) { return kResidualTexts[c]; }

std::string link_title(const SurveyRecord& record, const SolvedLink& link) {
  const PairResult& r = link.link.result;
  const ScanRecord* source = find_scan(record, link.link.source);
  const ScanRecord* target = find_scan(record, link.link.target);
  std::string text =
      fmt::format("{} → {}\n{}, probability {:.3f}\noverlap {}, residual {}", source ? source->name : "?",
                  target ? target->name : "?", word(r.verdict), r.probability, percent(r.overlap), metres(r.rms_m));
  if (link.after)
    text += fmt::format("\noff the solved poses by {}, {}", metres(link.after->translation_m),
                        degrees(link.after->rotation_rad));
  if (r.verdict == Verdict::accepted)
    text += link.in_loop ? fmt::format("\nconfirmed by a loop: {:.3f}", link.probability) : "\nno loop confirms it";
  else
    text += "\n" + r.reason;
  return text;
}

}  // namespace isthmus::report
