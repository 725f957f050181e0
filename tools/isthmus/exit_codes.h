// What the program's exit code says (docs/command_line.md).
#pragma once

namespace isthmus::cli {

inline constexpr int kSuccess = 0;  ///< register, run: all scans in one component; pair: accepted
inline constexpr int kFailure =
    1;                            ///< nothing useful came out: no input, an output that cannot be written, a full disk
inline constexpr int kUsage = 2;  ///< wrong usage or configuration; nothing was begun
inline constexpr int kUnconnected = 3;   ///< finished, but scans are unconnected or unreadable; pair: not accepted
inline constexpr int kUnfinished = 4;    ///< a shard whose next stage needs what other shards have not made yet
inline constexpr int kSignalBase = 128;  ///< stopped by signal N: 128 + N, as shells count

}  // namespace isthmus::cli
