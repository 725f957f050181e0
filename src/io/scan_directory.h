// Which files of a folder are scans, and what they are called.
//
// Scans are the files with a known extension (docs/formats.md), except poses*.txt, overlaps*.txt and *.gt.txt, and
// except text tables and prose without coordinates (.txt, .csv, .asc). Files and folders whose names begin with a dot
// are passed over. A scan that lies there in two formats (same folder, same stem) is taken once, in the order of the
// table of formats; the other is named in a warning. Names are relative to the input folder (scan_name.h).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_reader.h"

namespace isthmus::io {

struct ListedScan {
  ScanRef scan;
  std::optional<Error> error;  ///< why the file cannot be read at all (missing, no permission, unsupported format)
};

/// Files that stand for the same scan.
struct TwinFiles {
  std::filesystem::path taken;
  std::vector<std::filesystem::path> others;  ///< in the order of preference
};

struct ScanListing {
  std::filesystem::path base;         ///< what names are relative to
  std::vector<ListedScan> scans;      ///< sorted by name (bytewise), then by index in the file
  std::vector<TwinFiles> twins;       ///< sorted by path
  std::vector<std::string> warnings;  ///< what may have been meant as a scan and is not used; sorted
  std::vector<std::string> notes;     ///< for the log: what else was passed over and why; sorted
};

/// Folders are searched with their subfolders; files are taken as named, without the rules above. Names are relative to
/// the folder if there is one input and it is a folder, else to the deepest folder that holds all inputs. A file given
/// twice is listed once. `skip_folders` (an output folder inside the input, say) are not entered. Deterministic; the
/// order of `inputs` does not matter. Fails only if there is no input or none exists.
Result<ScanListing> list_scans(const std::vector<std::filesystem::path>& inputs,
                               const std::vector<std::filesystem::path>& skip_folders = {});

/// Where no scan of a file that has twins can be read, its next twin that can be is taken instead, and a warning says
/// so; where none can, the file stays. `trouble_of` reads a scan and says what is wrong with it; called from several
/// threads, for scans with twins only.
void take_readable_twins(ScanListing& listing, const std::function<std::optional<Error>(const ScanRef&)>& trouble_of);

/// A scan as a person names it: "scan.ply", or "file.ptx#2" (counted from 0) for one scan of several. The file may be
/// written as it is or percent-encoded as in the output files. Fails if the file is missing or a folder, or if it holds
/// several scans and none is named.
Result<ScanRef> resolve_scan_name(const std::string& text);

}  // namespace isthmus::io
