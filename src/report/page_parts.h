// The page's style sheet and script, inlined into report.html.
#pragma once

namespace isthmus::report {

extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace isthmus::report
