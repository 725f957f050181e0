// Any bytes as E57: with right checksums over them and the length in the header that they have, or else nothing behind
// the checksums would ever be reached; every other input (by its last byte) as it is.
#include "fuzz/read_scans.h"
#include "io/e57_testing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const isthmus::fuzz::BytesAsFile file("scan.e57");
  constexpr std::size_t kLengthAt = 16;
  constexpr std::size_t kPageBytes = 1020;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (!bytes.empty() && bytes.back() != '\1') {
    bytes.resize((bytes.size() + kPageBytes - 1) / kPageBytes * kPageBytes, '\0');
    const std::uint64_t length = bytes.size() / kPageBytes * (kPageBytes + sizeof(std::uint32_t));
    bytes.replace(kLengthAt, sizeof length, isthmus::io::testing::bytes_of_value(length));
    bytes = isthmus::io::testing::paged(bytes);
  }
  return isthmus::fuzz::read_scans(file, bytes);
}
