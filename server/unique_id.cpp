#include "server/unique_id.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include <unistd.h>

namespace signorini::server {
namespace {

using Bytes = std::array<std::uint8_t, 16>;

constexpr std::string_view alphabet = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr std::size_t id_length = 26;
constexpr std::size_t time_bytes = 6;

Bytes fresh_bytes() {
  using namespace std::chrono;
  Bytes bytes{};
  auto time =
      static_cast<std::uint64_t>(duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count());
  for (std::size_t i = time_bytes; i-- > 0; time >>= 8) bytes[i] = static_cast<std::uint8_t>(time & 0xff);
  if (::getentropy(bytes.data() + time_bytes, bytes.size() - time_bytes) != 0)
    throw std::runtime_error("the system gives no random bytes");
  return bytes;
}

/// Two jobs of one millisecond, or a clock that was set back: count on from the last id.
void increment(Bytes& bytes) {
  for (std::size_t i = bytes.size(); i-- > 0;) {
    if (++bytes[i] != 0) return;
  }
}

/// 128 bits in groups of five from the right; the first letter holds the three that are left.
std::string base32(const Bytes& bytes) {
  std::string text(id_length, '0');
  unsigned buffer = 0;
  int bits = 0;
  std::size_t next = bytes.size();
  for (std::size_t i = id_length; i-- > 0;) {
    if (bits < 5 && next > 0) {
      buffer |= static_cast<unsigned>(bytes[--next]) << bits;
      bits += 8;
    }
    text[i] = alphabet[buffer & 31];
    buffer >>= 5;
    bits -= 5;
  }
  return text;
}

}  // namespace

std::string UniqueIds::next() {
  const Bytes fresh = fresh_bytes();
  const std::lock_guard lock(mutex_);
  const bool later = std::lexicographical_compare(last_.begin(), last_.begin() + time_bytes, fresh.begin(),
                                                  fresh.begin() + time_bytes);
  if (later) {
    last_ = fresh;
  } else {
    increment(last_);
  }
  return base32(last_);
}

bool is_unique_id(std::string_view text) {
  return text.size() == id_length && std::all_of(text.begin(), text.end(), [](char c) {
           return alphabet.find(c) != std::string_view::npos;
         });
}

}  // namespace signorini::server
