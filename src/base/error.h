// Errors as values: what went wrong, where, with which value, and what to try.
#pragma once

#include <string>
#include <tl/expected.hpp>

namespace isthmus {

/// An expected failure (a bad file, too few points, a full disk). Reads as one sentence for a person.
struct Error {
  std::string what;   ///< what went wrong, a clause without a full stop: "unknown property type 'flaot'"
  std::string where;  ///< file, file and line, file and byte offset, or stage and scan; may be empty
  std::string hint;   ///< what to try; may be empty

  /// "<where>: <what> (<hint>)"
  [[nodiscard]] std::string text() const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an Error from a function that returns a Result.
inline tl::unexpected<Error> fail(std::string what, std::string where = {}, std::string hint = {}) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(hint)});
}

}  // namespace isthmus
