// The folder that a run writes its results to, held from before the first scan is read until the last file is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/error.h"

namespace isthmus::pipelines {

/// Holds OUT/.lock: an flock(2) that dies with its owner, so a killed run hinders no later one. The file also keeps the
/// space that the results will need, so that the products of the store cannot take it.
class OutputFolder {
 public:
  /// Creates the folder if need be. Fails at once when it is no folder, cannot be written, or when another run holds
  /// it.
  static Result<OutputFolder> open(const std::filesystem::path& folder);
  /// For one of several processes that carry out the same plan, named by a word: they hold the lock together; a whole
  /// run, or a shard of another plan, is refused and refuses.
  static Result<OutputFolder> open_shared(const std::filesystem::path& folder, const std::string& plan);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  /// Removes the lock if nobody else holds it, and the folder if it was created here and holds nothing.
  ~OutputFolder();

  /// Takes space on the disk until give_back(). Fails when there is not as much.
  Result<void> reserve(std::uint64_t bytes);
  void give_back();

 private:
  OutputFolder(std::filesystem::path folder, bool created, int descriptor)
      : folder_(std::move(folder)), created_(created), descriptor_(descriptor) {}
  static Result<OutputFolder> open_with(const std::filesystem::path& folder, const std::string& plan);

  std::filesystem::path folder_;
  bool created_ = false;
  int descriptor_ = -1;
};

}  // namespace isthmus::pipelines
