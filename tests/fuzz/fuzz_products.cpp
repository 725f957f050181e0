// Any bytes as what artifacts hold; the first says which product. What is read is written and read again to the same.
#include <cstdint>
#include <cstdlib>

#include "features/feature_cloud.h"
#include "pairwise/pair_result.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"
#include "store/archive.h"
#include "store/sample.h"

namespace {

template <class T>
void read(std::string_view bytes) {
  T value;
  isthmus::store::ArchiveReader reader(bytes);
  reader(value);
  if (!reader.complete()) return;
  const std::string written = isthmus::store::to_bytes(value);
  T again;
  isthmus::store::ArchiveReader second(written);
  second(again);
  if (!second.complete() || isthmus::store::to_bytes(again) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0]) {
    case 's':
      read<SampledScan>(bytes);
      break;
    case 'f':
      read<FeatureCloud>(bytes);
      break;
    case 'r':
      read<RegionMap>(bytes);
      break;
    case 'p':
      read<PairResult>(bytes);
      break;
    default:
      read<store::Sample>(bytes);
  }
  return 0;
}
