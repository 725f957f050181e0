// Any bytes as Wavefront OBJ.
#include "fuzz/read_scans.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const isthmus::fuzz::BytesAsFile file("scan.obj");
  return isthmus::fuzz::read_scans(file, {reinterpret_cast<const char*>(data), size});
}
