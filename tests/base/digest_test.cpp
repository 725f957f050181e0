#include "base/digest.h"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Digest, knows_the_published_value_of_the_empty_input) {
  EXPECT_EQ(Digest().hex(), "99aa06d3014798d86001c324468d497f");  // XXH3_128bits("", 0), from xxHash's test vectors
}

TEST(Digest, tells_where_one_text_ends) {
  EXPECT_NE(Digest().add("ab").add("c").hex(), Digest().add("a").add("bc").hex());
}

TEST(Digest, bytes_in_pieces_are_the_bytes_at_once) {
  const std::string text(100000, 'x');
  Digest pieces;
  for (std::size_t i = 0; i < text.size(); i += 7)
    pieces.add_bytes(text.data() + i, std::min<std::size_t>(7, text.size() - i));
  EXPECT_EQ(pieces.hex(), Digest().add_bytes(text.data(), text.size()).hex());
}

TEST(Digest, depends_on_every_argument) {
  EXPECT_NE(Digest().add(1).hex(), Digest().add(2).hex());
  EXPECT_NE(Digest().add(1.0).value64(), Digest().add(1.0).add(0.0).value64());
}

}  // namespace
}  // namespace isthmus
