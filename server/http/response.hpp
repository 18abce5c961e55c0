#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace signorini::server {

/// Takes the next piece of a body; false means that the client has gone.
using PieceSink = std::function<bool(std::string_view piece)>;

/// Writes a body piece by piece; returns false if the sink ended it. May be called again, and then begins
/// anew.
using BodyWriter = std::function<bool(const PieceSink& sink)>;

/// A body that comes to be over time, in parts between which no thread waits. Used by one thread at a time.
class PartSource {
 public:
  virtual ~PartSource() = default;

  /// Writes what there is by now; false if the sink ended it.
  virtual bool write(const PieceSink& sink) = 0;
  /// Whether nothing will follow.
  virtual bool is_complete() const = 0;
  /// Arranges that `ready` is called, by any thread, as soon as there may be more than was written, while
  /// what is returned lives.
  virtual std::shared_ptr<void> subscribe(std::function<void()> ready) = 0;
};

/// How long a reply may be. One that is not brief is made and sent where others need not wait for it, and a
/// list not where results are, each of which may take a hundred times as long.
enum class Length { brief, list, result };

struct LaterReply;

/// One reply: a body that is there, one that is written while it is sent, or one that outlives the exchange;
/// or the promise of a reply.
struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  const std::string* compressed = nullptr;  ///< the body by gzip, if it is always the same
  BodyWriter write_body;
  std::shared_ptr<PartSource> parts;
  std::function<bool()> in_the_way;  ///< whether others wait for what it holds until it is sent; may be empty
  /// Sends the reply itself, of which the head is there.
  std::function<void(int socket, std::string head)> take_connection;
  std::shared_ptr<const LaterReply> later;  ///< then the rest says nothing
  std::vector<std::pair<std::string, std::string>> headers;
  std::string job;  ///< id of the job that the reply is about, for the log

  static Response json(int status, std::string text);
  static Response empty(int status);
};

/// A reply that is made when something has happened, and for which no thread waits.
struct LaterReply {
  std::string job;                              ///< id of the job that it is about, for the log
  std::chrono::steady_clock::time_point until;  ///< by when it is made in any case
  std::shared_ptr<void> place;                  ///< of those who may wait
  /// Arranges that `ready` is called, by any thread, as soon as the reply can be made, while what is returned
  /// lives.
  std::function<std::shared_ptr<void>(std::function<void()> ready)> subscribe;
  /// Makes the reply; the request is still there.
  std::function<Response()> make;
  /// Does instead what is to be done when the client has left.
  std::function<void()> leave;
};

}  // namespace signorini::server
