#include "report/view_script.h"

namespace isthmus::report {

const char* const kViewScript = "";

}  // namespace isthmus::report
