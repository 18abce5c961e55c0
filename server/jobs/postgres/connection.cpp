#include "server/jobs/postgres/connection.hpp"

#include <array>
#include <charconv>

#include <poll.h>

namespace signorini::server::postgres {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* reads_only = "25006";

std::string first_line(const char* text) {
  const std::string_view all = text == nullptr ? "" : text;
  std::string line(all.substr(0, all.find('\n')));
  return line.empty() ? "no reason is given" : line;
}

/// What libpq takes where the URL does not say it: a database that is cut off is noticed soon, and of several
/// hosts the one that takes writes is found.
PGconn* connect(const std::string& url) {
  const std::array keywords{"connect_timeout",  "tcp_user_timeout",
                            "keepalives_idle",  "keepalives_interval",
                            "keepalives_count", "target_session_attrs",
                            "client_encoding",  "fallback_application_name",
                            "dbname",           static_cast<const char*>(nullptr)};
  const std::array values{"3",          "5000", "5",          "2",         "3",
                          "read-write", "UTF8", "signorinid", url.c_str(), static_cast<const char*>(nullptr)};
  constexpr int dbname_may_be_a_url = 1;
  return PQconnectdbParams(keywords.data(), values.data(), dbname_may_be_a_url);
}

}  // namespace

void Values::add(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  add(std::string(text.data(), end));
}

void Values::add(const std::vector<std::string>& texts) {
  std::string array = "{";
  for (const std::string& text : texts) {
    array += array.size() > 1 ? ",\"" : "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') array += '\\';
      array += c;
    }
    array += '"';
  }
  add(array + "}");
}

std::string_view Rows::view(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<std::size_t>(PQgetlength(result_.get(), row, column))};
}

/// Of a bigint, an integer or a boolean: binary, most significant byte first.
std::int64_t Rows::integer(int row, int column) const {
  const std::string_view bytes = view(row, column);
  std::uint64_t value = !bytes.empty() && (bytes[0] & 0x80) != 0 ? ~std::uint64_t{0} : 0;
  for (const char byte : bytes) value = value << 8 | static_cast<unsigned char>(byte);
  return static_cast<std::int64_t>(value);
}

Connection::Connection(const std::string& url, std::chrono::seconds patience)
    : patience_(patience), connection_(connect(url), PQfinish) {
  if (PQstatus(connection_.get()) != CONNECTION_OK) lose(first_line(PQerrorMessage(connection_.get())));
  PQsetnonblocking(connection_.get(), 1);
  // Whoever is stopped within a step holds nobody up for longer than that. To compile a statement takes
  // longer than all of ours do.
  script("SET statement_timeout = '" + std::to_string(longest_statement.count()) +
         "s'; SET idle_in_transaction_session_timeout = '10s'; SET jit = off");
}

Rows Connection::run(const std::string& sql, const Values& values) {
  const std::string& name = prepared(sql, values.size());
  std::vector<const char*> texts;
  std::vector<int> lengths, binary;
  for (const Values::Value& value : values.values_) {
    const std::string_view content = value.is_binary ? value.bytes : std::string_view(value.text);
    // An empty view may be null, which would be NULL.
    texts.push_back(!value.is_there ? nullptr : content.empty() ? "" : content.data());
    lengths.push_back(static_cast<int>(content.size()));
    binary.push_back(value.is_binary ? 1 : 0);
  }
  constexpr int in_binary = 1;
  return answer(PQsendQueryPrepared(connection_.get(), name.c_str(), static_cast<int>(texts.size()),
                                    texts.data(), lengths.data(), binary.data(), in_binary) == 1);
}

const std::string& Connection::prepared(const std::string& sql, std::size_t values) {
  const auto known = prepared_.find(sql);
  if (known != prepared_.end()) return known->second;
  const std::string name = "s" + std::to_string(prepared_.size());
  answer(PQsendPrepare(connection_.get(), name.c_str(), sql.c_str(), static_cast<int>(values), nullptr) == 1);
  return prepared_.emplace(sql, name).first->second;
}

void Connection::script(const std::string& sql) {
  answer(PQsendQuery(connection_.get(), sql.c_str()) == 1);
}

void Connection::lock(const std::string& name) {
  run("SELECT pg_advisory_xact_lock(hashtext(current_schema() || ' ' || $1))", Values(name));
}

bool Connection::is_lost() {
  if (is_lost_) return true;
  pollfd socket{PQsocket(connection_.get()), POLLIN, 0};
  if (::poll(&socket, 1, 0) > 0 && PQconsumeInput(connection_.get()) == 0) is_lost_ = true;
  return is_lost_;
}

bool Connection::wait_for_notification(std::chrono::milliseconds time) {
  const auto take_all = [this] {
    bool any = false;
    while (PGnotify* const notification = PQnotifies(connection_.get())) {
      PQfreemem(notification);
      any = true;
    }
    return any;
  };
  if (take_all()) return true;
  if (!wait(POLLIN, Clock::now() + time)) return false;
  if (PQconsumeInput(connection_.get()) == 0) lose(first_line(PQerrorMessage(connection_.get())));
  return take_all();
}

/// False if nothing comes until then.
bool Connection::wait(short events, Clock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  pollfd socket{PQsocket(connection_.get()), events, 0};
  return ::poll(&socket, 1, static_cast<int>(std::max<decltype(left)>(left, 0))) > 0;
}

/// Of what was sent: its rows, those of the last one if it was several.
Rows Connection::answer(bool sent) {
  PGconn* const connection = connection_.get();
  if (!sent) lose(first_line(PQerrorMessage(connection)));
  const auto until = Clock::now() + patience_;
  const auto wait_for = [&](short events) {
    if (!wait(events, until)) lose("the database does not answer");
    if (PQconsumeInput(connection) == 0) lose(first_line(PQerrorMessage(connection)));
  };
  for (int left = PQflush(connection); left != 0; left = PQflush(connection)) {
    if (left < 0) lose(first_line(PQerrorMessage(connection)));
    wait_for(POLLIN | POLLOUT);
  }
  std::optional<Rows> rows;
  std::optional<Error> error;
  for (;;) {
    while (PQisBusy(connection) != 0) wait_for(POLLIN);
    PGresult* const result = PQgetResult(connection);
    if (result == nullptr) break;
    rows.emplace(result);
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_EMPTY_QUERY) continue;
    const char* const state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
    const char* const text = PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
    if (!error)
      error.emplace(first_line(text != nullptr ? text : PQresultErrorMessage(result)),
                    state != nullptr ? state : "");
  }
  if (PQstatus(connection) != CONNECTION_OK) is_lost_ = true;
  // Of several hosts, another one may take writes by now.
  if (error && error->state == reads_only) is_lost_ = true;
  if (error) throw *std::move(error);
  return *std::move(rows);
}

void Connection::lose(const std::string& why) {
  is_lost_ = true;
  throw Error(why);
}

Transaction::~Transaction() {
  if (is_over_ || connection_.is_lost()) return;
  try {
    connection_.script("ROLLBACK");
  } catch (const Error&) {
    // Then the connection is lost, which rolls back too.
  }
}

void Transaction::commit() {
  is_over_ = true;
  connection_.script("COMMIT");
}

}  // namespace signorini::server::postgres
