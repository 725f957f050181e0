// The bundled script of the 3D view (tools/report_view); empty where the build had no npm.
#pragma once

namespace isthmus::report {

extern const char* const kViewScript;

}  // namespace isthmus::report
