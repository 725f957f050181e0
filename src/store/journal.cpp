#include "store/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <ctime>
#include <system_error>

#include "base/atomic_file.h"
#include "base/disk_space.h"

namespace isthmus::store {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFields = 6;

double now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

/// Sorts by time as text: 20261127T011925Z-host-1234.tsv
std::string name_of_this_process() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {'?'};
  return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}Z-{}-{}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec, host.data(), ::getpid());
}

/// Tabs and line feeds separate; in an item they would be read as such.
std::string plain(std::string text) {
  for (char& c : text) c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  return text;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool read_number(const std::string& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Result<std::shared_ptr<Journal>> Journal::open(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return tl::unexpected(write_error("the journal's folder cannot be created", error.value(), folder));
  const std::string name = name_of_this_process();
  for (int i = 0;; ++i) {  // a process may run several jobs in one second
    const fs::path path = folder / (i == 0 ? name + ".tsv" : fmt::format("{}-{}.tsv", name, i));
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
    if (descriptor >= 0) return std::shared_ptr<Journal>(new Journal(descriptor));
    if (errno != EEXIST) return tl::unexpected(write_error("the journal cannot be created", errno, path));
  }
}

Journal::~Journal() { ::close(descriptor_); }

void Journal::write(JournalLine line) {
  const std::string text = fmt::format("{:.3f}\t{}\t{}\t{}\t{}\t{:.6g}\n", now(), line.event, line.stage, line.digest,
                                       plain(line.item), line.seconds);
  [[maybe_unused]] const ssize_t written = ::write(descriptor_, text.data(), text.size());
}

void Journal::write_once(JournalLine line) {
  {
    const std::lock_guard lock(mutex_);
    if (!written_once_.insert(fmt::format("{}/{}/{}", line.event, line.stage, line.digest)).second) return;
  }
  write(std::move(line));
}

std::size_t ProcessJournal::count(const std::string& event) const {
  return static_cast<std::size_t>(std::ranges::count(lines, event, &JournalLine::event));
}

std::vector<ProcessJournal> read_journals(const fs::path& folder) {
  std::vector<ProcessJournal> journals;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".tsv") journals.push_back({entry->path(), {}});
  }
  std::ranges::sort(journals, {}, &ProcessJournal::file);
  for (ProcessJournal& journal : journals) {
    const Result<std::string> text = read_file(journal.file);
    if (!text) continue;
    std::vector<std::string> rows = split(*text, '\n');
    rows.pop_back();  // behind the last line feed: nothing, or a line that was cut
    for (const std::string& row : rows) {
      const std::vector<std::string> fields = split(row, '\t');
      JournalLine line;
      if (fields.size() != kFields || !read_number(fields[0], line.time) || !read_number(fields[5], line.seconds))
        continue;
      line.event = fields[1];
      line.stage = fields[2];
      line.digest = fields[3];
      line.item = fields[4];
      journal.lines.push_back(std::move(line));
    }
  }
  return journals;
}

}  // namespace isthmus::store
