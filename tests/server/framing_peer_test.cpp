// Another strict parser (http_parser of Node.js) reads the same bytes: where both take a request, they must
// agree on where it ends and what its body is. What one of them alone refuses cannot be misunderstood.

#include "server/http/message_reader.hpp"

#include <random>

#include <gtest/gtest.h>
#include <http_parser.h>

namespace signorini::server::framing_peer_test {
namespace {

/// What a parser makes of some bytes: the bodies of the requests that it takes, up to the first that it
/// refuses or that has not ended.
struct Reading {
  std::vector<std::string> methods;
  std::vector<std::string> bodies;
};

Reading ours(const std::string& bytes, std::size_t piece) {
  MessageReader reader{MessageLimits()};
  Reading reading;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.take(std::string_view(bytes).substr(at, piece));
    while (reader.stage() == MessageReader::Stage::whole) {
      const Message message = reader.next();
      if (message.refusal) return reading;
      reading.methods.push_back(message.method);
      reading.bodies.push_back(message.body);
      if (!message.may_follow) return reading;
    }
  }
  return reading;
}

Reading theirs(const std::string& bytes) {
  Reading reading;
  std::string body;
  struct State {
    Reading& reading;
    std::string& body;
  } state{reading, body};
  http_parser_settings settings;
  http_parser_settings_init(&settings);
  settings.on_body = [](http_parser* parser, const char* at, std::size_t length) {
    static_cast<State*>(parser->data)->body.append(at, length);
    return 0;
  };
  settings.on_message_complete = [](http_parser* parser) {
    auto& [kept, read] = *static_cast<State*>(parser->data);
    kept.methods.emplace_back(http_method_str(static_cast<http_method>(parser->method)));
    kept.bodies.push_back(std::exchange(read, {}));
    return http_should_keep_alive(parser) ? 0 : 1;
  };
  http_parser parser;
  http_parser_init(&parser, HTTP_REQUEST);
  parser.data = &state;
  http_parser_execute(&parser, &settings, bytes.data(), bytes.size());
  return reading;
}

/// Heads and bodies that are sound, or nearly.
class Inventor {
 public:
  explicit Inventor(unsigned seed) : random_(seed) {}

  std::string request() {
    std::string text = pick({"GET", "POST", "POST", "PUT", "DELETE", "HEAD"}) + " /" +
                       pick({"", "a", "a?b=c", "%41"}) + " HTTP/1." + pick({"1", "1", "1", "0"}) +
                       "\r\nHost: h\r\n";
    for (int i = number(3); i > 0; --i) text += header();
    return text + "\r\n" +
           pick({"", "{}", "2\r\n{}\r\n0\r\n\r\n", "1\r\na\r\n0\r\nX: y\r\n\r\n", "0\r\n\r\n", "hello",
                 "a;b=c\r\n0123456789\r\n0\r\n\r\n"});
  }

  /// Changes a few bytes, most of them where it matters.
  std::string mutated(std::string text) {
    for (int i = number(3); i > 0 && !text.empty(); --i) {
      const std::size_t at = static_cast<std::size_t>(number(static_cast<int>(text.size()) - 1));
      const std::string byte = pick({"\r", "\n", " ", "\t", ":", ",", ";", "0", "2", "-", "+", "x",
                                     std::string(1, '\0'), "\x0b", "\xff", "%"});
      const int what = number(2);
      if (what == 0) text.insert(at, byte);
      if (what == 1) text[at] = byte[0];
      if (what == 2) text.erase(at, 1);
    }
    return text;
  }

  std::size_t piece() { return static_cast<std::size_t>(1 + number(40)); }

 private:
  std::string header() {
    return pick({"Content-Length", "content-length", "Transfer-Encoding", "TRANSFER-ENCODING", "Connection",
                 "X"}) +
           pick({": ", ":", ":\t", ": ", " : "}) +
           pick({"2", "5", "0", "02", "2, 2", "chunked", "Chunked", "gzip, chunked", "chunked, gzip",
                 "identity", "close", "keep-alive", "", "x"}) +
           pick({"\r\n", "\r\n", "\r\n", " \r\n", "\n", "\r\n "});
  }

  std::string pick(std::initializer_list<std::string> choices) {
    return *(choices.begin() + number(static_cast<int>(choices.size()) - 1));
  }
  int number(int most) { return std::uniform_int_distribution<int>(0, most)(random_); }

  std::mt19937 random_;
};

TEST(FramingPeer, AgreesOnEveryRequestThatBothTake) {
  constexpr int rounds = 200'000;
  int both = 0;
  Inventor inventor(1);
  for (int round = 0; round < rounds; ++round) {
    const std::string bytes = inventor.mutated(inventor.request()) + inventor.mutated(inventor.request());
    const Reading us = ours(bytes, inventor.piece());
    const Reading them = theirs(bytes);
    const std::size_t common = std::min(us.bodies.size(), them.bodies.size());
    both += common > 0;
    for (std::size_t i = 0; i < common; ++i) {
      ASSERT_EQ(us.methods[i], them.methods[i]) << testing::PrintToString(bytes);
      ASSERT_EQ(us.bodies[i], them.bodies[i]) << testing::PrintToString(bytes);
    }
  }
  // Else nothing was compared.
  EXPECT_GT(both, rounds / 10);
}

/// However the bytes come, they are understood alike.
TEST(FramingPeer, IsNotSwayedByPieces) {
  Inventor inventor(2);
  for (int round = 0; round < 20'000; ++round) {
    const std::string bytes = inventor.mutated(inventor.request()) + inventor.request();
    const Reading whole = ours(bytes, bytes.size() + 1);
    const Reading pieces = ours(bytes, inventor.piece());
    const Reading single = ours(bytes, 1);
    ASSERT_EQ(whole.bodies, pieces.bodies) << testing::PrintToString(bytes);
    ASSERT_EQ(whole.bodies, single.bodies) << testing::PrintToString(bytes);
  }
}

}  // namespace
}  // namespace signorini::server::framing_peer_test
