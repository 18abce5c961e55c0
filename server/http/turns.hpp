#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace signorini::server {

/// Something to do for a client.
struct Task {
  std::function<void()> work;
  std::string sender = {};  ///< the client, or its network
  std::chrono::steady_clock::time_point due =
      {};                                  ///< of the tasks of one sender, this says which comes first
  std::function<bool()> is_unwanted = {};  ///< whether its client has left; empty: nobody asks
};

/// Tasks that wait to be done. Senders take turns: however many tasks one of them has, the task of another is
/// the next but one.
class Turns {
 public:
  bool empty() const { return waiting_.empty(); }

  void add(Task task);

  /// The next one; nothing if none waits.
  std::optional<Task> take();

  /// All whose clients have left.
  std::vector<Task> take_unwanted();

 private:
  using Tasks = std::multimap<std::chrono::steady_clock::time_point, Task>;  ///< by when they are due

  std::map<std::string, Tasks> waiting_;  ///< by sender
  std::string last_;                      ///< whose turn was the last one
};

/// When a body is due to be read that came at this time. A shorter one is due earlier, for it is read sooner,
/// but within limits: a long one does not wait for ever.
std::chrono::steady_clock::time_point due(std::chrono::steady_clock::time_point came, std::uint64_t bytes);

}  // namespace signorini::server
