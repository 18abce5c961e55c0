#pragma once

#include <functional>

namespace signorini::server {

/// SIGINT and SIGTERM, which stop the service, and SIGHUP, taken by one thread that waits for them. There is
/// one object at a time.
class StopSignals {
 public:
  /// To be made before the threads of the service, which then leave the signals to the one that waits.
  StopSignals();

  /// Returns when one that stops arrives. Calls `on_hangup` for each SIGHUP until then.
  void wait(const std::function<void()>& on_hangup) const;

  /// Whether one that stops has arrived since the last that was waited for; takes it.
  bool take() const;

  /// From now on one ends the process at once, even where it is the first of its container.
  void leave() const;

  /// As if one that stops had arrived.
  static void raise();
};

}  // namespace signorini::server
