#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace signorini::server {

/// The log of a database of SQLite, read without SQLite (https://www.sqlite.org/fileformat2.html#walformat).
/// SQLite itself takes the first frame whose checksum is wrong for the end of the log, without a word.
class WriteAheadLog {
 public:
  static constexpr std::size_t page_bytes = 4096;  ///< SQLite's default, which every database of jobs has

  /// A page as a transaction wrote it.
  struct Frame {
    std::size_t place;    ///< in the log, in frames
    std::uint32_t page;   ///< its number
    bool commits;         ///< it is the last one of its transaction
    std::size_t content;  ///< where in the log
  };

  /// The log of this database, empty if there is none.
  explicit WriteAheadLog(const std::filesystem::path& database);

  bool is_empty() const { return bytes_.empty(); }

  /// Those frames of the log's last life that are as they were written, committed or not.
  const std::vector<Frame>& frames() const { return frames_; }
  std::string_view content(const Frame& frame) const {
    return std::string_view(bytes_).substr(frame.content, page_bytes);
  }

  /// In words, if SQLite would not see all that was committed: a transaction ends behind a frame that is not
  /// what was written. What a process that died had not committed is no fault. The very last frame cannot be
  /// told from one that was never written to its end, nor can the writes of a machine that lost its power
  /// between two syncs from damage.
  std::optional<std::string> fault() const;

 private:
  bool head_is_whole_ = true;
  std::string bytes_;
  std::vector<Frame> frames_;
};

}  // namespace signorini::server
