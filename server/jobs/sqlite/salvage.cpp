#include "server/jobs/sqlite/salvage.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/jobs/sqlite/byte_order.hpp"
#include "server/jobs/sqlite/write_ahead_log.hpp"

namespace signorini::server {
namespace {

// --- the pages

constexpr std::size_t page_bytes = WriteAheadLog::page_bytes;
constexpr std::size_t head_bytes = 100;  // of the file, on its first page

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The pages of a database, numbered from 1, with those of its log in their places.
class Pages {
 public:
  explicit Pages(const std::filesystem::path& file) : file_(content_of(file)), log_(file) {
    if (file_.empty() && log_.is_empty())
      throw std::runtime_error("nothing can be read from " + file.string());
    read_log();
    note_unused();
  }

  std::uint32_t count() const {
    const auto in_file = static_cast<std::uint32_t>(file_.size() / page_bytes);
    return logged_.empty() ? in_file : std::max(in_file, logged_.rbegin()->first);
  }

  /// Nothing beyond the end.
  std::optional<std::string_view> page(std::uint32_t number) const {
    const auto logged = logged_.find(number);
    if (logged != logged_.end()) return logged->second.content;
    if (number == 0 || number > file_.size() / page_bytes) return std::nullopt;
    return std::string_view(file_).substr((number - 1) * page_bytes, page_bytes);
  }

  /// The numbers of all, those that were written last first: where the last writing of a page is lost, what
  /// it held before may have gone to another one since.
  std::vector<std::uint32_t> newest_first() const {
    std::vector<std::uint32_t> numbers(count());
    std::iota(numbers.begin(), numbers.end(), 1);
    std::ranges::stable_sort(numbers, std::greater(), [this](std::uint32_t number) {
      const auto logged = logged_.find(number);
      return logged == logged_.end() ? 0 : logged->second.place + 1;
    });
    return numbers;
  }

  /// Whether the page was given up, and what it holds may be a job that was deleted.
  bool is_unused(std::uint32_t number) const { return unused_.contains(number) || is_marked_unused(number); }

 private:
  struct Logged {
    std::size_t place;
    std::string_view content;
  };

  /// Up to the last frame that ends a transaction.
  void read_log() {
    std::map<std::uint32_t, Logged> open;
    for (const WriteAheadLog::Frame& frame : log_.frames()) {
      open[frame.page] = {frame.place, log_.content(frame)};
      if (!frame.commits) continue;
      for (const auto& [number, page] : open) logged_[number] = page;
      open.clear();
    }
  }

  void note_unused() {
    const auto first = page(1);
    std::uint32_t trunk = first ? big_endian(*first, 32) : 0;
    while (trunk != 0 && unused_.insert(trunk).second) {
      const auto bytes = page(trunk);
      if (!bytes) return;
      const std::uint32_t leaves = std::min<std::uint32_t>(big_endian(*bytes, 4), page_bytes / 4 - 2);
      for (std::uint32_t i = 0; i < leaves; ++i) unused_.insert(big_endian(*bytes, 8 + 4 * i));
      trunk = big_endian(*bytes, 0);
    }
  }

  /// By the page that tells what the pages after it are for.
  bool is_marked_unused(std::uint32_t number) const {
    constexpr std::uint32_t entry_bytes = 5, entries = page_bytes / entry_bytes, unused = 2;
    if (number < 3) return false;
    const std::uint32_t map = 2 + (number - 2) / (entries + 1) * (entries + 1);
    const auto bytes = page(map);
    return map != number && bytes && big_endian(*bytes, entry_bytes * (number - map - 1), 1) == unused;
  }

  const std::string file_;
  const WriteAheadLog log_;
  std::map<std::uint32_t, Logged> logged_;  ///< what was written last of the pages in the log
  std::set<std::uint32_t> unused_;
};

// --- the rows on them

struct Value {
  enum class Kind { null, integer, text, blob };
  Kind kind = Kind::null;
  std::int64_t number = 0;
  std::string bytes;
};
using Row = std::vector<Value>;

/// Reads on from a place; nothing once the bytes have ended.
class Reader {
 public:
  Reader(std::string_view bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  std::optional<std::uint64_t> varint() {
    std::uint64_t number = 0;
    for (int i = 0; i < 9; ++i) {
      if (at_ >= bytes_.size()) return std::nullopt;
      const auto byte = static_cast<std::uint8_t>(bytes_[at_++]);
      if (i == 8) return number << 8 | byte;
      number = number << 7 | (byte & 0x7f);
      if (byte < 0x80) return number;
    }
    return number;
  }

  std::size_t at() const { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_;
};

/// A big-endian number with its sign.
std::int64_t signed_number(std::string_view bytes) {
  std::uint64_t number = !bytes.empty() && static_cast<std::int8_t>(bytes[0]) < 0 ? ~std::uint64_t{0} : 0;
  for (const char byte : bytes) number = number << 8 | static_cast<std::uint8_t>(byte);
  return static_cast<std::int64_t>(number);
}

/// Takes a value of this serial type off the bytes. Nothing if they are too few, or it is of no type that is
/// used.
std::optional<Value> take_value(std::uint64_t type, std::string_view& bytes) {
  constexpr std::array<std::size_t, 7> integer_bytes{0, 1, 2, 3, 4, 6, 8};
  Value value;
  std::size_t length = 0;
  if (type == 8 || type == 9) {
    value.kind = Value::Kind::integer;
    value.number = type == 9;
    return value;
  }
  if (type == 0) return value;
  if (type < integer_bytes.size()) {
    value.kind = Value::Kind::integer;
    length = integer_bytes[type];
  } else if (type >= 12) {
    value.kind = type % 2 == 0 ? Value::Kind::blob : Value::Kind::text;
    length = (type - 12) / 2;
  } else {
    return std::nullopt;
  }
  if (length > bytes.size()) return std::nullopt;
  if (value.kind == Value::Kind::integer) value.number = signed_number(bytes.substr(0, length));
  if (value.kind != Value::Kind::integer) value.bytes = bytes.substr(0, length);
  bytes.remove_prefix(length);
  return value;
}

std::optional<Row> row_of(std::string_view record) {
  Reader head(record, 0);
  const auto length = head.varint();
  if (!length || *length > record.size()) return std::nullopt;
  std::string_view body = record.substr(*length);
  Row row;
  while (head.at() < *length) {
    const auto type = head.varint();
    if (!type || head.at() > *length) return std::nullopt;
    auto value = take_value(*type, body);
    if (!value) return std::nullopt;
    row.push_back(*std::move(value));
  }
  return row;
}

/// The record that begins here with its length, the rest of it on pages of its own.
std::optional<std::string> record_at(const Pages& pages, std::string_view page, std::size_t at,
                                     bool of_table) {
  Reader head(page, at);
  const auto length = head.varint();
  if (!length || *length > std::size_t{pages.count()} * page_bytes) return std::nullopt;
  if (of_table && !head.varint()) return std::nullopt;
  const std::size_t most = of_table ? page_bytes - 35 : (page_bytes - 12) * 64 / 255 - 23;
  const std::size_t least = (page_bytes - 12) * 32 / 255 - 23;
  std::size_t local = *length;
  if (*length > most) {
    local = least + (*length - least) % (page_bytes - 4);
    if (local > most) local = least;
  }
  const bool overflows = local < *length;
  if (head.at() + local + (overflows ? 4 : 0) > page.size()) return std::nullopt;
  std::string record(page.substr(head.at(), local));
  std::uint32_t next = overflows ? big_endian(page, head.at() + local) : 0;
  while (record.size() < *length) {
    const auto bytes = pages.page(next);
    if (!bytes) return std::nullopt;
    record += bytes->substr(4, *length - record.size());
    next = big_endian(*bytes, 0);
  }
  return record;
}

/// Calls `take(row, of_table)` for every row on the page that can be read.
template <typename Take>
void for_each_row(const Pages& pages, std::uint32_t number, const Take& take) {
  constexpr std::uint32_t index_inside = 2, index_leaf = 10, table_leaf = 13;
  const auto page = pages.page(number);
  if (!page || pages.is_unused(number)) return;
  const std::size_t head = number == 1 ? head_bytes : 0;
  const std::uint32_t kind = big_endian(*page, head, 1);
  if (kind != index_inside && kind != index_leaf && kind != table_leaf) return;
  const std::size_t places = head + (kind == index_inside ? 12 : 8);
  const std::size_t cells = big_endian(*page, head + 3, 2);
  for (std::size_t i = 0; i < cells && places + 2 * i + 2 <= page_bytes; ++i) {
    const std::size_t cell = big_endian(*page, places + 2 * i, 2);
    const std::size_t record = cell + (kind == index_inside ? 4 : 0);
    const auto bytes = record_at(pages, *page, record, kind == table_leaf);
    const auto row = bytes ? row_of(*bytes) : std::nullopt;
    if (row) take(*row, kind == table_leaf);
  }
}

// --- into the new database

void bind_value(SQLite::Statement& statement, int index, const Value& value) {
  switch (value.kind) {
    case Value::Kind::null:
      return statement.bind(index);
    case Value::Kind::integer:
      return statement.bind(index, value.number);
    case Value::Kind::text:
      return statement.bind(index, value.bytes);
    case Value::Kind::blob:
      return statement.bind(index, value.bytes.data(), static_cast<int>(value.bytes.size()));
  }
}

/// By a statement that takes the row or not.
void insert(SQLite::Statement& statement, const Row& row) {
  try {
    for (std::size_t i = 0; i < row.size(); ++i) bind_value(statement, static_cast<int>(i) + 1, row[i]);
    statement.exec();
  } catch (const SQLite::Exception&) {
    // No row of this table, or one that its rules do not allow: what only looked like one.
  }
  statement.tryReset();
  statement.clearBindings();
}

/// Columns of `jobs` since rows are sealed.
constexpr std::size_t sealed_columns = 16;

/// A row of `jobs` that was written before there were the last columns, all of which are texts.
Row with_defaults(Row row, std::size_t columns) {
  Value empty;
  empty.kind = Value::Kind::text;
  if (row.size() < columns) row.resize(columns, empty);
  return row;
}

std::string question_marks(std::size_t count) {
  std::string marks = "?";
  for (std::size_t i = 1; i < count; ++i) marks += ", ?";
  return marks;
}

bool is_text(const Value& value) {
  return value.kind == Value::Kind::text;
}

}  // namespace

std::size_t salvage(const std::filesystem::path& file, SQLite::Database& whole) {
  const Pages pages(file);
  whole.exec("PRAGMA foreign_keys = OFF");
  SQLite::Transaction transaction(whole);
  const auto columns =
      static_cast<std::size_t>(whole.execAndGet("SELECT count(*) FROM pragma_table_info('jobs')").getInt());
  // Of several rows of an id the first one counts.
  SQLite::Statement job(whole, "INSERT OR IGNORE INTO jobs VALUES (" + question_marks(columns) + ")");
  SQLite::Statement problem(whole, "INSERT OR IGNORE INTO problems VALUES (?, ?)");
  SQLite::Statement piece(whole, "INSERT OR IGNORE INTO results VALUES (?, ?, ?)");
  SQLite::Statement batch(whole, "INSERT OR IGNORE INTO batches VALUES (?, ?, ?, ?, ?, ?)");
  SQLite::Statement key(whole, "INSERT OR IGNORE INTO idempotency_keys VALUES (?, ?, ?)");
  for (const std::uint32_t number : pages.newest_first()) {
    for_each_row(pages, number, [&](const Row& row, bool of_table) {
      if (row.empty() || !is_text(row[0])) return;
      if (!of_table && row.size() >= sealed_columns) insert(job, with_defaults(row, columns));
      if (of_table && row.size() == 2 && row[1].kind == Value::Kind::blob) insert(problem, row);
      if (of_table && row.size() == 3 && row[2].kind == Value::Kind::blob) insert(piece, row);
      if (!of_table && row.size() == 6 && row[5].kind == Value::Kind::blob) insert(batch, row);
      if (!of_table && row.size() == 3 && is_text(row[1]) && is_text(row[2])) insert(key, row);
    });
  }
  const auto found = static_cast<std::size_t>(whole.execAndGet("SELECT count(*) FROM jobs").getInt64());
  transaction.commit();
  whole.exec("PRAGMA foreign_keys = ON");
  return found;
}

}  // namespace signorini::server
