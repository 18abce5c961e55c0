#pragma once

#include <bit>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <libpq-fe.h>

namespace signorini::server::postgres {

/// What a statement may take in the database, where it does not say otherwise.
constexpr std::chrono::seconds longest_statement{10};

/// What the database, or the way to it, says went wrong.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text, std::string of_state = {})
      : std::runtime_error(text), state(std::move(of_state)) {}

  std::string state;  ///< SQLSTATE; empty: the connection is lost, and whether a step was done is not known
};

/// Bytes as a value of a statement, which they must outlive.
struct Bytes {
  std::string_view bytes;
};

/// The values of a statement in the order of $1, $2 and so on.
class Values {
 public:
  template <class... Each>
  explicit Values(const Each&... each) {
    (add(each), ...);
  }

  void add(std::string text) { values_.push_back({std::move(text), {}, true, false}); }
  void add(const char* text) { add(std::string(text)); }
  void add(bool value) { add(value ? "t" : "f"); }
  void add(std::integral auto value) { add(std::to_string(value)); }
  void add(double value);
  void add(const Bytes& bytes) { values_.push_back({{}, bytes.bytes, true, true}); }
  template <class Value>
  void add(const std::optional<Value>& value) {
    if (value)
      add(*value);
    else
      values_.push_back({{}, {}, false, false});
  }
  /// As an array of texts.
  void add(const std::vector<std::string>& texts);

  std::size_t size() const { return values_.size(); }

 private:
  friend class Connection;
  struct Value {
    std::string text;
    std::string_view bytes;
    bool is_there, is_binary;
  };
  std::vector<Value> values_;
};

/// What a statement returns.
class Rows {
 public:
  explicit Rows(PGresult* result) : result_(result, PQclear) {}

  int size() const { return PQntuples(result_.get()); }
  bool empty() const { return size() == 0; }

  bool is_null(int row, int column) const { return PQgetisnull(result_.get(), row, column) != 0; }
  /// A text, or bytes.
  std::string_view view(int row, int column) const;
  std::string text(int row, int column) const { return std::string(view(row, column)); }
  std::int64_t integer(int row, int column) const;
  double number(int row, int column) const { return std::bit_cast<double>(integer(row, column)); }
  bool boolean(int row, int column) const { return view(row, column)[0] != 0; }

 private:
  std::shared_ptr<PGresult> result_;
};

/// A connection to a PostgreSQL database, for one thread at a time. Whatever it does may throw Error.
class Connection {
 public:
  /// `url` is postgresql://…, with whatever parameters libpq knows. It waits so long for each answer.
  Connection(const std::string& url, std::chrono::seconds patience);

  /// Runs one statement, which is prepared the first time.
  Rows run(const std::string& sql, const Values& values = Values());
  /// Runs several statements without values.
  void script(const std::string& sql);

  /// Waits until no other transaction with the same tables has the lock of this name, and has it until its
  /// own transaction ends.
  void lock(const std::string& name);

  /// Whether it can be used no more: something was lost on the way, or the server has closed it meanwhile.
  bool is_lost();

  /// Waits for a notification, or so long. False if there was none.
  bool wait_for_notification(std::chrono::milliseconds time);

 private:
  bool wait(short events, std::chrono::steady_clock::time_point until);
  Rows answer(bool sent);
  [[noreturn]] void lose(const std::string& why);
  const std::string& prepared(const std::string& sql, std::size_t values);

  const std::chrono::seconds patience_;
  std::unique_ptr<PGconn, decltype(&PQfinish)> connection_;
  std::map<std::string, std::string> prepared_;  ///< the name of each statement
  bool is_lost_ = false;
};

/// What is done while it lives is done as a whole, by commit(), or not at all.
class Transaction {
 public:
  explicit Transaction(Connection& connection, const std::string& isolation = "READ COMMITTED")
      : connection_(connection) {
    connection_.script("BEGIN ISOLATION LEVEL " + isolation);
  }
  ~Transaction();

  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  Connection& connection_;
  bool is_over_ = false;
};

}  // namespace signorini::server::postgres
