#include "server/http/arrival.hpp"

#include <gtest/gtest.h>

namespace signorini::server {
namespace {

Arrival of(std::string_view bytes) {
  return arrival_of(bytes, 200, 20);
}

TEST(Arrival, OfAHead) {
  const std::string head = "GET / HTTP/1.1\r\nHost: h\r\n\r\n";
  for (std::size_t n = 0; n < head.size(); ++n) EXPECT_EQ(of(head.substr(0, n)), Arrival::part) << n;
  EXPECT_EQ(of(head), Arrival::whole);
  EXPECT_EQ(of(head + "GET /next"), Arrival::whole);
  EXPECT_EQ(of(std::string(200, 'x')), Arrival::whole);  // too long
}

TEST(Arrival, OfASizedBody) {
  const std::string head = "POST / HTTP/1.1\r\ncontent-LENGTH:  5\r\n\r\n";
  EXPECT_EQ(of(head + "1234"), Arrival::part);
  EXPECT_EQ(of(head + "12345"), Arrival::whole);
  const std::string long_head = "POST / HTTP/1.1\r\nContent-Length: 21\r\n\r\n";
  EXPECT_EQ(of(long_head), Arrival::long_body);
  EXPECT_EQ(of(long_head + std::string(21, 'x')), Arrival::whole);
  EXPECT_EQ(of("POST / HTTP/1.1\r\nX-Content-Length: 9\r\n\r\n"), Arrival::whole);
}

TEST(Arrival, OfChunks) {
  const std::string head = "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n";
  const std::string body = "5\r\n0\r\n\r\n\r\n1;a=b\r\nx\r\n0\r\nTrailer: t\r\n\r\n";
  for (std::size_t n = 0; n < 20; ++n) EXPECT_EQ(of(head + body.substr(0, n)), Arrival::part) << n;
  for (std::size_t n = 20; n < body.size(); ++n) {
    EXPECT_EQ(of(head + body.substr(0, n)), Arrival::long_body) << n;
  }
  EXPECT_EQ(of(head + body), Arrival::whole);
  EXPECT_EQ(of(head + "x"), Arrival::part);
  EXPECT_EQ(of(head + "x\r\n"), Arrival::whole);  // no chunk
  EXPECT_EQ(of(head + "ffffffffffffffff\r\n"), Arrival::whole);
  EXPECT_EQ(of(head + "fffffffffffffffff\r\n"), Arrival::whole);
}

TEST(Arrival, OfWhatIsRefusedAnyway) {
  for (const char* framing :
       {"Content-Length: x", "Content-Length: -1", "Transfer-Encoding: gzip, chunked", "Content-Length: 99999999999999999999999",
        "Content-Length: 5\r\nTransfer-Encoding: chunked"}) {
    EXPECT_EQ(of("POST / HTTP/1.1\r\n" + std::string(framing) + "\r\n\r\n"), Arrival::whole) << framing;
  }
}

TEST(Arrival, OfAClientThatAsksFirst) {
  const std::string head = "POST / HTTP/1.1\r\nExpect: 100-continue\r\nContent-Length: 5\r\n\r\n";
  EXPECT_EQ(of(head), Arrival::long_body);
  EXPECT_EQ(of(head + "12345"), Arrival::whole);
}

}  // namespace
}  // namespace signorini::server
