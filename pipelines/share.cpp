#include "pipelines/share.h"

#include <charconv>

namespace isthmus::pipelines {

Result<Share> Share::parse(const std::string& text) {
  const auto wrong = fail("a shard is K/N with 1 <= K <= N, such as 2/3", "--shard " + text);
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return wrong;
  std::size_t k = 0, n = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), text.data() + slash, k);
  const auto second = std::from_chars(text.data() + slash + 1, end, n);
  if (first.ec != std::errc() || first.ptr != text.data() + slash) return wrong;
  if (second.ec != std::errc() || second.ptr != end || k < 1 || k > n) return wrong;
  return Share{k - 1, n};
}

}  // namespace isthmus::pipelines
