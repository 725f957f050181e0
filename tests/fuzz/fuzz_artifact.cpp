// Any bytes as the envelope of an artifact, with a right checksum behind them.
#include <xxhash.h>

#include <cstdint>

#include "fuzz/bytes_as_file.h"
#include "store/sample.h"
#include "store/store.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  static const store::Key key = {"sample", "00112233445566778899aabbccddeeff"};
  static const fuzz::BytesAsFile file("store/sample/00/00112233445566778899aabbccddeeff.artifact");
  static const Result<store::Store> store = store::Store::open(file.folder() / "store", [](const Error&) {});
  if (!store || store->path_of(key) != file.path()) std::abort();
  XXH128_canonical_t checksum;
  XXH128_canonicalFromHash(&checksum, XXH3_128bits(data, size));
  std::string bytes(reinterpret_cast<const char*>(data), size);
  bytes.append(reinterpret_cast<const char*>(checksum.digest), sizeof checksum.digest);
  file.write(bytes);
  (void)store->load<store::Sample>(key);
  (void)store->load<std::string>(key);
  return 0;
}
