#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <ostream>
#include <streambuf>
#include <utility>

#include "io/las/laszip_handle.h"
#include "io/las/laz.h"

namespace isthmus::io {
namespace {

/// The file as LASzip's streams want it: appended to, told its length, and once overwritten further up.
class FileBuffer final : public std::streambuf {
 public:
  explicit FileBuffer(OutputFile& file) : file_(file) {}
  void set_length(std::uint64_t length) { place_ = length_ = length; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  /// Hands what was appended to the file.
  bool flush() {
    if (Result<void> written = file_.write(appended_); !written && !error_) error_ = written.error();
    appended_.clear();
    return !error_;
  }

 protected:
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* data, std::streamsize n) override {
    constexpr std::size_t kBytes = std::size_t{1} << 18;  // LASzip writes a kilobyte at a time
    const std::string_view bytes(data, static_cast<std::size_t>(n));
    if (place_ == length_) {
      appended_ += bytes;
      length_ += bytes.size();
      if (appended_.size() >= kBytes && !flush()) return 0;
    } else {
      if (!flush()) return 0;
      if (Result<void> written = file_.overwrite(place_, bytes); !written) error_ = written.error();
      if (error_) return 0;
    }
    place_ += bytes.size();
    return n;
  }
  int sync() override { return flush() ? 0 : -1; }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const std::uint64_t base = from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? place_ : length_;
    place_ = base + static_cast<std::uint64_t>(offset);
    return {static_cast<off_type>(place_)};
  }
  pos_type seekpos(pos_type place, std::ios_base::openmode mode) override {
    return seekoff(static_cast<off_type>(place), std::ios_base::beg, mode);
  }

 private:
  OutputFile& file_;
  std::string appended_;
  std::uint64_t place_ = 0, length_ = 0;  // of the file with what was appended
  std::optional<Error> error_;
};

template <class T>
void take(T& value, std::string_view record, std::size_t offset) {
  std::memcpy(&value, record.data() + offset, sizeof(T));
}

class LaszipStream final : public LazStream {
 public:
  LaszipStream(OutputFile& file, unsigned format, std::string name)
      : format_(format), name_(std::move(name)), buffer_(file), stream_(&buffer_) {}

  Result<void> prepare(std::size_t record_bytes) {
    laszip_U8* bytes = nullptr;
    laszip_U32 size = 0;
    const laszip_POINTER laszip = laszip_.get();
    if (laszip_set_point_type_and_size(laszip, static_cast<laszip_U8>(format_),
                                       static_cast<laszip_U16>(record_bytes)) != 0 ||
        laszip_request_native_extension(laszip, 1) != 0 || laszip_create_laszip_vlr(laszip, &bytes, &size) != 0)
      return failure();
    record_.assign(reinterpret_cast<const char*>(bytes), size);
    return {};
  }
  [[nodiscard]] const std::string& record() const override { return record_; }

  Result<void> begin_points(std::uint64_t points_begin) override {
    buffer_.set_length(points_begin);
    const laszip_POINTER laszip = laszip_.get();
    if (laszip_open_writer_stream(laszip, stream_, 1, 1) != 0 || laszip_get_point_pointer(laszip, &point_) != 0)
      return failure();
    return {};
  }

  Result<void> add(std::string_view record) override {
    take(point_->X, record, 0);
    take(point_->Y, record, 4);
    take(point_->Z, record, 8);
    take(point_->intensity, record, 12);
    // Of a return only the first of one is written.
    if (format_ < 6) {
      point_->return_number = point_->number_of_returns = 1;
      take(point_->point_source_ID, record, 18);
      if (format_ == 2) take_colour(record, 20);
    } else {
      point_->extended_point_type = 1;
      point_->extended_return_number = point_->extended_number_of_returns = 1;
      take(point_->point_source_ID, record, 20);
      take(point_->gps_time, record, 22);
      if (format_ == 7) take_colour(record, 30);
    }
    return laszip_write_point(laszip_.get()) == 0 && !buffer_.error() ? Result<void>() : failure();
  }

  Result<void> end() override {
    return laszip_close_writer(laszip_.get()) == 0 && buffer_.flush() ? Result<void>() : failure();
  }

 private:
  void take_colour(std::string_view record, std::size_t offset) {
    for (std::size_t c = 0; c < 3; ++c) take(point_->rgb[c], record, offset + 2 * c);
  }
  [[nodiscard]] Result<void> failure() const {
    if (buffer_.error()) return tl::unexpected(*buffer_.error());
    return fail("LASzip cannot write it: " + laszip_.error(), name_);
  }

  unsigned format_;
  std::string name_;
  std::string record_;
  FileBuffer buffer_;
  std::ostream stream_;
  laszip_point_struct* point_ = nullptr;
  LaszipHandle laszip_;  // last: it ends before the stream it writes to
};

}  // namespace

Result<std::unique_ptr<LazStream>> LazStream::create(OutputFile& file, unsigned format, std::size_t record_bytes,
                                                     const std::string& name) {
  auto stream = std::make_unique<LaszipStream>(file, format, name);
  if (auto prepared = stream->prepare(record_bytes); !prepared) return tl::unexpected(std::move(prepared.error()));
  return stream;
}

}  // namespace isthmus::io
