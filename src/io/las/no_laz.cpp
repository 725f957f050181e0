// For builds without LASzip.
#include "io/las/laz.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr const char* kHint =
    "this build has no LASzip: tools/setup.sh makes it, then configure again (ISTHMUS_LAZ); or use LAS";

}  // namespace

bool has_laz() { return false; }

OpenedScan open_laz(InputFile file, const LasHeader&) {
  return fail("unsupported format: compressed LAS (LAZ)", at_byte(file.name(), 104), kHint);
}

Result<std::unique_ptr<LazStream>> LazStream::create(OutputFile&, unsigned, std::size_t, const std::string& name) {
  return fail("compressed LAS (LAZ) cannot be written", name, kHint);
}

}  // namespace isthmus::io
