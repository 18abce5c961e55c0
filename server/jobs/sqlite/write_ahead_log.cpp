#include "server/jobs/sqlite/write_ahead_log.hpp"

#include <array>
#include <fstream>

#include "server/jobs/sqlite/byte_order.hpp"

namespace signorini::server {
namespace {

constexpr std::size_t log_head = 32, frame_head = 24, frame_bytes = frame_head + WriteAheadLog::page_bytes;
constexpr std::size_t word = 4, salts = 8;

using Checksum = std::array<std::uint32_t, 2>;

/// That of the head and of every frame, which goes on from the one before.
Checksum stored(std::string_view bytes, std::size_t offset) {
  return {big_endian(bytes, offset), big_endian(bytes, offset + word)};
}

Checksum goes_on(Checksum sum, std::string_view bytes, bool words_are_big_endian) {
  const auto read = [&](std::string_view from, std::size_t at) {
    return words_are_big_endian ? big_endian(from, at) : little_endian(from, at);
  };
  for (std::size_t at = 0; at < bytes.size(); at += 2 * word) {
    sum[0] += read(bytes, at) + sum[1];
    sum[1] += read(bytes, at + word) + sum[0];
  }
  return sum;
}

}  // namespace

WriteAheadLog::WriteAheadLog(const std::filesystem::path& database) {
  std::ifstream stream(database.string() + "-wal", std::ios::binary);
  bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  const std::string_view log = bytes_;
  if (log.size() < log_head + frame_bytes) return;
  const bool words_are_big_endian = (big_endian(log, 0) & 1) != 0;
  const std::size_t of_head = log_head - salts;
  head_is_whole_ = goes_on({}, log.substr(0, of_head), words_are_big_endian) == stored(log, of_head);
  // The frames of a life have the salts of its head; an earlier life may have left others behind them.
  const std::string_view life = log.substr(head_is_whole_ ? 16 : log_head + 8, salts);
  Checksum before = stored(log, of_head);
  for (std::size_t place = 0; log_head + (place + 1) * frame_bytes <= log.size(); ++place) {
    const std::size_t at = log_head + place * frame_bytes, content = at + frame_head;
    const Checksum own = stored(log, at + 16);
    const Checksum found = goes_on(goes_on(before, log.substr(at, 8), words_are_big_endian),
                                   log.substr(content, page_bytes), words_are_big_endian);
    if (log.substr(at + 8, salts) == life && found == own)
      frames_.push_back({place, big_endian(log, at), big_endian(log, at + 4) != 0, content});
    before = own;
  }
}

std::optional<std::string> WriteAheadLog::fault() const {
  std::size_t place = 0;
  for (const Frame& frame : frames_) {
    if (frame.place == place && head_is_whole_) {
      ++place;
    } else if (frame.commits) {
      return head_is_whole_ ? "frame " + std::to_string(place + 1) + " of its log is not what was written"
                            : "the head of its log is not what was written";
    }
  }
  return std::nullopt;
}

}  // namespace signorini::server
