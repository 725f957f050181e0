// Any bytes as the journal of a process.
#include <cstdint>

#include "fuzz/bytes_as_file.h"
#include "store/journal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const isthmus::fuzz::BytesAsFile file("20250101T000000-host-1.tsv");
  file.write({reinterpret_cast<const char*>(data), size});
  for (const auto& journal : isthmus::store::read_journals(file.folder())) (void)journal.count("made");
  return 0;
}
