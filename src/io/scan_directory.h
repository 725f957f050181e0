// Which files of a folder are scans, and what they are called.
//
// Scans are the files with a known extension (docs/formats.md), except poses*.txt, overlaps*.txt and *.gt.txt, and
// except text tables and prose without coordinates (.txt, .csv, .asc). Files and folders whose names begin with a dot
// are passed over. A scan that lies there in two formats (same folder, same stem) is taken once, in the order of the
// table of formats; the other is named in a note. Names are relative to the input folder (scan_name.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

struct ListedScan {
  ScanRef scan;
  std::optional<Error> error;  ///< why the file cannot be read at all (missing, no permission, unsupported format)
};

struct ScanListing {
  std::vector<ListedScan> scans;   ///< sorted by name (bytewise), then by index in the file
  std::vector<std::string> notes;  ///< for the log: what was passed over and why; sorted
};

/// Folders are searched with their subfolders; files are taken as named, without the rules above. Names are relative to
/// the folder if there is one input and it is a folder, else to the deepest folder that holds all inputs. A file given
/// twice is listed once. `skip_folders` (an output folder inside the input, say) are not entered. Deterministic; the
/// order of `inputs` does not matter. Fails only if there is no input or none exists.
Result<ScanListing> list_scans(const std::vector<std::filesystem::path>& inputs,
                               const std::vector<std::filesystem::path>& skip_folders = {});

/// A scan as a person names it: "scan.ply", or "file.ptx#2" (counted from 0) for one scan of several. The file may be
/// written as it is or percent-encoded as in the output files. Fails if the file is missing or a folder, or if it holds
/// several scans and none is named.
Result<ScanRef> resolve_scan_name(const std::string& text);

}  // namespace isthmus::io
