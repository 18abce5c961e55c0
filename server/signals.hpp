#pragma once

namespace signorini::server {

/// SIGINT and SIGTERM, taken by one thread that waits for them. There is one object at a time.
class StopSignals {
 public:
  /// To be made before the threads of the service, which then leave the signals to the one that waits.
  StopSignals();

  /// Returns when one arrives.
  void wait() const;

  /// Whether one has arrived since the last that was waited for; takes it.
  bool take() const;

  /// From now on one ends the process at once.
  void leave() const;

  /// As if one had arrived.
  static void raise();
};

}  // namespace signorini::server
