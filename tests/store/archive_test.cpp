#include "store/archive.h"

#include <gtest/gtest.h>

#include "store/sample.h"

namespace isthmus::store {
namespace {

TEST(Archive, reads_back_every_kind_of_member) {
  const Sample written = full_sample();
  const std::string bytes = to_bytes(written);
  Sample read;
  read.perhaps_real = 5;  // must be taken away again
  ArchiveReader reader(bytes);
  reader(read);
  ASSERT_TRUE(reader.complete());
  EXPECT_EQ(read.flag, written.flag);
  EXPECT_EQ(read.number, written.number);
  EXPECT_EQ(read.real, written.real);
  EXPECT_EQ(read.colour, written.colour);
  EXPECT_EQ(read.text, written.text);
  EXPECT_EQ(read.bytes, written.bytes);
  EXPECT_EQ(read.point, written.point);
  EXPECT_EQ(read.pose.matrix(), written.pose.matrix());
  EXPECT_EQ(read.information, written.information);
  EXPECT_EQ(read.points, written.points);
  EXPECT_EQ(read.inners, written.inners);
  ASSERT_TRUE(read.perhaps);
  EXPECT_EQ(read.perhaps->matrix(), written.perhaps->matrix());
  EXPECT_FALSE(read.perhaps_real);
  EXPECT_EQ(read.named, written.named);
  EXPECT_EQ(to_bytes(read), bytes);
}

TEST(Archive, bytes_are_the_documented_ones) {
  EXPECT_EQ(to_bytes(std::string("ab")), std::string("\2\0\0\0\0\0\0\0ab", 10));
  EXPECT_EQ(to_bytes(std::optional<std::uint8_t>(7)), std::string("\1\7", 2));
  EXPECT_EQ(to_bytes(std::vector<std::uint16_t>{1, 2}), std::string("\2\0\0\0\0\0\0\0\1\0\2\0", 12));
}

TEST(Archive, cut_anywhere_is_incomplete_and_never_reads_outside) {
  const std::string bytes = to_bytes(full_sample());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const std::string cut = bytes.substr(0, length);  // its own allocation, so that a sanitizer sees a read too far
    Sample read;
    ArchiveReader reader(cut);
    reader(read);
    EXPECT_FALSE(reader.complete()) << length;
  }
  const std::string longer = bytes + "x";
  Sample read;
  ArchiveReader reader(longer);
  reader(read);
  EXPECT_FALSE(reader.complete());
}

TEST(Archive, a_huge_length_reserves_nothing) {
  const std::string bytes = to_bytes(std::uint64_t{1} << 60) + "abc";
  std::vector<double> values;
  std::vector<Inner> inners;
  std::string text;
  ArchiveReader of_values(bytes), of_inners(bytes), of_text(bytes);
  of_values(values);
  of_inners(inners);
  of_text(text);
  EXPECT_FALSE(of_values.complete());
  EXPECT_FALSE(of_inners.complete());
  EXPECT_FALSE(of_text.complete());
  EXPECT_TRUE(values.empty() && inners.empty() && text.empty());
}

}  // namespace
}  // namespace isthmus::store
