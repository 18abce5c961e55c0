#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/http/semaphore.hpp"

namespace signorini::server {

/// The events of one stream (text/event-stream), asked for as fast as the client takes them.
class EventSource {
 public:
  virtual ~EventSource() = default;

  /// Appends the events that there are by now, a few at a time. False if none will follow.
  virtual bool next(std::string& text) = 0;
};

/// Sends events to any number of subscribers from one thread, so that none of them holds a thread of those
/// that answer requests. A client that takes nothing for a while is dropped; it can ask again for what it
/// missed.
class EventStreams {
 public:
  /// After `silence` without an event a comment is sent, so that nobody on the way takes the connection for
  /// dead.
  explicit EventStreams(std::size_t max_subscribers,
                        std::chrono::milliseconds silence = std::chrono::seconds(15));
  ~EventStreams();

  EventStreams(const EventStreams&) = delete;
  EventStreams& operator=(const EventStreams&) = delete;

  /// One for each subscriber.
  Semaphore& open_streams() { return open_streams_; }

  /// Sends the head of the reply and the events of the source to the socket, which is closed when they have
  /// ended.
  void add(int socket, std::string head, std::shared_ptr<EventSource> source, std::shared_ptr<void> place);

  /// Ends all streams after what their sources have to say now.
  void stop();

 private:
  struct Subscriber;

  void run();
  void take_newcomers();
  void wait();

  const std::chrono::milliseconds silence_;
  Semaphore open_streams_;
  const int wake_event_;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Subscriber>> newcomers_;
  std::vector<std::unique_ptr<Subscriber>> subscribers_;  ///< of the thread alone
  std::thread thread_;
};

}  // namespace signorini::server
