#include "conformance_cases.hpp"

#include "api/document/gzip.hpp"

namespace signorini::server {
namespace {

constexpr After goes_on = After::goes_on;
constexpr After closes = After::closes;

/// With bytes that no literal can hold.
std::string zero() {
  return std::string(1, '\0');
}

std::string repeated(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

/// A request that is sound but for this line.
std::string line(const std::string& request_line) {
  return request_line + "\r\nHost: localhost\r\n\r\n";
}

std::string get(const std::string& headers = {}) {
  return "GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
}

/// With the header lines as they are given, Host among them.
std::string bare_get(const std::string& headers) {
  return "GET /healthz HTTP/1.1\r\n" + headers + "\r\n";
}

/// 422 says that `{}` was read, exactly and as JSON; 400 that something else was.
std::string post(const std::string& headers, const std::string& body,
                 const std::string& path = "/v1/validate") {
  return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" + headers +
         "\r\n" + body;
}

/// The head of a request with a body, of the type that the headers say.
std::string typed(const std::string& headers, const std::string& path = "/v1/validate") {
  return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
}

/// Of a body that may be a request itself.
std::string sized(const std::string& body) {
  return post("Content-Length: " + std::to_string(body.size()) + "\r\n", body);
}

std::string chunked(const std::string& body) {
  return post("Transfer-Encoding: chunked\r\n", body);
}

std::string coded(const std::string& coding, const std::string& body) {
  return post("Content-Encoding: " + coding + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n",
              body);
}

std::string gzipped(const std::string& text) {
  std::string bytes;
  const api::Sink append = [&](std::string_view piece) {
    bytes += piece;
    return true;
  };
  api::Gzip gzip(append);
  gzip.put(text);
  gzip.finish();
  return bytes;
}

/// `{}` by RFC 1950, in one stored block.
std::string deflated() {
  return std::string("\x78\x01\x01\x02\x00\xfd\xff{}\x01\x75\x00\xf9", 13);
}

CaseGroup lines() {
  return {
      "Lines",  // RFC 9112, 2.2
      {{"an empty line before", "\r\n" + get(), {200}},
       {"two empty lines before", "\r\n\r\n" + get(), {200}},
       {"countless empty lines before", repeated(20, "\r\n") + get(), {400}, closes},
       {"line feeds alone", "GET /healthz HTTP/1.1\nHost: localhost\n\n", {400}, closes},
       {"a line feed alone after the request line",
        "GET /healthz HTTP/1.1\nHost: localhost\r\n\r\n",
        {400},
        closes},
       {"a line feed alone after a header", "GET /healthz HTTP/1.1\r\nHost: localhost\n\r\n", {400}, closes},
       {"a line feed alone at the end", "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\n", {400}, closes},
       {"a line feed before", "\n" + get(), {400}, closes},
       {"a carriage return before", "\r" + get(), {400}, closes},
       {"a carriage return alone in a value", get("X: a\rb\r\n"), {400}, closes},
       {"a carriage return alone in the request line", line("GET /heal\rthz HTTP/1.1"), {400}, closes},
       {"carriage returns alone", "GET /healthz HTTP/1.1\rHost: localhost\r\r", {400}, closes},
       {"two carriage returns", get("X: a\r\r\n"), {400}, closes},
       {"a blank before the first header",
        "GET /healthz HTTP/1.1\r\n X: a\r\nHost: localhost\r\n\r\n",
        {400},
        closes},
       {"a tab before the first header",
        "GET /healthz HTTP/1.1\r\n\tX: a\r\nHost: localhost\r\n\r\n",
        {400},
        closes},
       {"a blank line before the first header",
        "GET /healthz HTTP/1.1\r\n \r\nHost: localhost\r\n\r\n",
        {400},
        closes},
       {"one word", "HELLO\r\n\r\n", {400}, closes},
       {"a reply", "HTTP/1.1 200 OK\r\n\r\n", {400}, closes},
       {"a zero byte", zero() + "\r\n\r\n", {400}, closes},
       {"the greeting of TLS", "\x16\x03\x01\x02" + zero() + "\x01\r\n\r\n", {400}, closes}}};
}

CaseGroup request_line() {
  return {"RequestLine",  // RFC 9112, 3
          {{"two blanks before the target", line("GET  /healthz HTTP/1.1"), {400}, closes},
           {"two blanks after the target", line("GET /healthz  HTTP/1.1"), {400}, closes},
           {"a tab before the target", line("GET\t/healthz HTTP/1.1"), {400}, closes},
           {"a tab after the target", line("GET /healthz\tHTTP/1.1"), {400}, closes},
           {"a form feed before the target", line("GET\f/healthz HTTP/1.1"), {400}, closes},
           {"a vertical tab after the target", line("GET /healthz\vHTTP/1.1"), {400}, closes},
           {"a blank before", line(" GET /healthz HTTP/1.1"), {400}, closes},
           {"a blank after", line("GET /healthz HTTP/1.1 "), {400}, closes},
           {"a tab after", line("GET /healthz HTTP/1.1\t"), {400}, closes},
           {"a word after", line("GET /healthz HTTP/1.1 x"), {400}, closes},
           {"a blank within the target", line("GET /heal thz HTTP/1.1"), {400}, closes},
           {"no version", line("GET /healthz"), {400}, closes},
           {"no version but its blank", line("GET /healthz "), {400}, closes},
           {"no target", line("GET HTTP/1.1"), {400}, closes},
           {"no method", line("/healthz HTTP/1.1"), {400}, closes},
           {"no method but its blank", line(" /healthz HTTP/1.1"), {400}, closes}}};
}

CaseGroup methods() {
  const std::string length = "Content-Length: 2\r\n\r\n{}";
  return {
      "Methods",  // RFC 9110, 9, and 15.6.2
      {{"in small letters", line("get /healthz HTTP/1.1"), {501}, closes},
       {"in mixed letters", line("Get /healthz HTTP/1.1"), {501}, closes},
       {"unknown", line("FOO /healthz HTTP/1.1"), {501}, closes},
       {"unknown, with signs of a token", line("M-SEARCH!#$%&'*+.^_`|~ /healthz HTTP/1.1"), {501}, closes},
       {"long", line(std::string(200, 'A') + " /healthz HTTP/1.1"), {501}, closes},
       {"endless", std::string(10'000, 'A'), {501}, closes},
       {"CONNECT", line("CONNECT localhost:80 HTTP/1.1"), {501}, closes},
       {"no token", line("G(T /healthz HTTP/1.1"), {400}, closes},
       {"with a colon", line("GET: /healthz HTTP/1.1"), {400}, closes},
       {"with a control character", line("G\001T /healthz HTTP/1.1"), {400}, closes},
       {"with a zero byte", line("GET" + zero() + " /healthz HTTP/1.1"), {400}, closes},
       {"beyond ASCII", line("G\xc3\x8bT /healthz HTTP/1.1"), {400}, closes},
       {"PUT names what is allowed",
        "PUT /v1/solves HTTP/1.1\r\nHost: localhost\r\n" + length,
        {405},
        goes_on,
        "\r\nAllow: POST, GET, HEAD, DELETE, OPTIONS\r\n"},
       {"PATCH",
        "PATCH /v1/validate HTTP/1.1\r\nHost: localhost\r\n" + length,
        {405},
        goes_on,
        "\r\nAllow: POST, OPTIONS\r\n"},
       {"TRACE", line("TRACE / HTTP/1.1"), {405}, goes_on, "\r\nAllow: GET, HEAD, OPTIONS\r\n"},
       {"DELETE", line("DELETE /healthz HTTP/1.1"), {405}, goes_on, "\r\nAllow: "},
       {"OPTIONS", line("OPTIONS /healthz HTTP/1.1"), {204}, goes_on, "\r\nAllow: GET, HEAD, OPTIONS\r\n"},
       {"OPTIONS of what is posted",
        line("OPTIONS /v1/solves HTTP/1.1"),
        {204},
        goes_on,
        "\r\nAllow: POST, GET, HEAD, DELETE, OPTIONS\r\n"},
       {"OPTIONS with a body",
        "OPTIONS /v1/validate HTTP/1.1\r\nHost: localhost\r\n" + length,
        {204},
        goes_on,
        "\r\nAllow: POST, OPTIONS\r\n"},
       {"OPTIONS of a target without a path",
        line("OPTIONS http://localhost HTTP/1.1"),
        {204},
        goes_on,
        "\r\nAllow: GET, HEAD, OPTIONS\r\n"},
       {"OPTIONS whatever is accepted",
        "OPTIONS /docs HTTP/1.1\r\nHost: localhost\r\nAccept: image/png\r\n\r\n",
        {204}},
       {"OPTIONS of nothing", line("OPTIONS /nothing HTTP/1.1"), {404}},
       {"OPTIONS of the service", line("OPTIONS * HTTP/1.1"), {204}, goes_on, "\r\nAllow: GET, HEAD, POST"},
       {"HEAD", line("HEAD /healthz HTTP/1.1"), {200}, goes_on, "\r\nContent-Length: 15\r\n"},
       {"HEAD of nothing", line("HEAD /nothing HTTP/1.1"), {404}, goes_on},
       {"HEAD of what can only be posted", line("HEAD /v1/validate HTTP/1.1"), {405}, goes_on},
       {"HEAD of a large document", line("HEAD /openapi.json HTTP/1.1"), {200}, goes_on}}};
}

/// A body after it would be taken for the next reply.
CaseGroup refused_heads() {
  const auto head = [](const std::string& headers) {
    return "HEAD /healthz HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
  };
  return {"RefusedHead",  // RFC 9110, 9.3.2
          {{"with too long a head", head("X: " + std::string(17'000, 'a') + "\r\n"), {431}, closes},
           {"with too many headers", head(repeated(1000, "X: a\r\n")), {431}, closes},
           {"with too long a target", line("HEAD /" + std::string(9000, 'a') + " HTTP/1.1"), {414}, closes},
           {"of another version", line("HEAD / HTTP/2.0"), {505}, closes},
           {"with a line that begins with a blank", head(" X: a\r\n"), {400}, closes},
           {"with a line that ends with a line feed alone", head("X: a\n"), {400}, closes},
           {"with a bad name", head("X Y: a\r\n"), {400}, closes},
           {"with a zero byte", head("X: " + zero() + "\r\n"), {400}, closes},
           {"without a host", "HEAD / HTTP/1.1\r\n\r\n", {400}, closes},
           {"with a bad length", head("Content-Length: x\r\n"), {400}, closes},
           {"with too long a body", head("Content-Length: 99999999\r\n"), {413}, closes},
           {"with another coding", head("Transfer-Encoding: x, chunked\r\n"), {501}, closes},
           {"with an expectation", head("Expect: x\r\n"), {417}, closes},
           {"with a bad target", line("HEAD /< HTTP/1.1"), {400}, closes},
           {"of what is no path", line("HEAD healthz HTTP/1.1"), {400}, closes},
           {"behind its body",
            head("Content-Length: 2\r\n") + "{}" + line("GET / HTTP/2.0"),
            {200, 505},
            closes}}};
}

CaseGroup targets() {
  CaseGroup group{
      "Targets",  // RFC 9112, 3.2, and RFC 3986
      {{"with a query", line("GET /v1/solves?limit=1 HTTP/1.1"), {200}},
       {"with an empty query", line("GET /healthz? HTTP/1.1"), {200}},
       {"with a query in percent", line("GET /v1/solves?%6cimit=%31 HTTP/1.1"), {200}},
       {"with all signs of a path", line("GET /a-._~!$&'()*+,;=:@%41/ HTTP/1.1"), {404}},
       {"an unreserved letter in percent", line("GET /%68ealth%7a HTTP/1.1"), {200}},
       {"an encoded slash is none", line("GET /v1%2Fsolves HTTP/1.1"), {404}},
       {"with two slashes", line("GET //healthz HTTP/1.1"), {404}},
       {"absolute", line("GET http://localhost/healthz HTTP/1.1"), {200}},
       {"absolute, in capitals", line("GET HTTP://LOCALHOST/healthz HTTP/1.1"), {200}},
       {"absolute with a port", line("GET http://localhost:8080/healthz HTTP/1.1"), {200}},
       {"absolute with an empty port", line("GET http://localhost:/healthz HTTP/1.1"), {200}},
       {"absolute with a query", line("GET http://localhost/v1/solves?limit=1 HTTP/1.1"), {200}},
       {"absolute without a path", line("GET http://localhost HTTP/1.1"), {200}},
       {"absolute with an IPv4 address", line("GET http://127.0.0.1:80/healthz HTTP/1.1"), {200}},
       {"absolute with an IPv6 address", line("GET http://[::1]:80/healthz HTTP/1.1"), {200}},
       {"absolute, and the Host says otherwise",
        "GET http://localhost/healthz HTTP/1.1\r\nHost: other.example\r\n\r\n",
        {200}},
       {"absolute, without a Host", "GET http://localhost/healthz HTTP/1.1\r\n\r\n", {400}, closes},
       {"absolute, posted",
        "POST http://localhost/v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: 2\r\n\r\n{}",
        {422}},
       {"absolute without a host", line("GET http:///healthz HTTP/1.1"), {400}, closes},
       {"absolute with a user", line("GET http://me@localhost/healthz HTTP/1.1"), {400}, closes},
       {"absolute with a bad port", line("GET http://localhost:x/healthz HTTP/1.1"), {400}, closes},
       {"absolute with an open bracket", line("GET http://[::1/healthz HTTP/1.1"), {400}, closes},
       {"absolute, of a secured connection", line("GET https://localhost/healthz HTTP/1.1"), {421}, closes},
       {"absolute, of another scheme", line("GET ftp://localhost/healthz HTTP/1.1"), {400}, closes},
       {"a scheme without an authority", line("GET http:/healthz HTTP/1.1"), {400}, closes},
       {"an authority", line("GET localhost:80 HTTP/1.1"), {400}, closes},
       {"without a slash", line("GET healthz HTTP/1.1"), {400}, closes},
       {"a query alone", line("GET ?limit=1 HTTP/1.1"), {400}, closes},
       {"a star, to be got", line("GET * HTTP/1.1"), {400}, closes},
       {"a star, to be looked at", line("HEAD * HTTP/1.1"), {400}, closes},
       {"with a fragment", line("GET /healthz#top HTTP/1.1"), {400}, closes},
       {"a percent sign alone", line("GET /healthz% HTTP/1.1"), {400}, closes},
       {"a percent sign with one digit", line("GET /healthz%4 HTTP/1.1"), {400}, closes},
       {"a percent sign with no digits", line("GET /healthz%zz HTTP/1.1"), {400}, closes},
       {"a percent sign in a query", line("GET /v1/solves?limit=%g1 HTTP/1.1"), {400}, closes},
       {"beyond ASCII", line("GET /h\xc3\xa9 HTTP/1.1"), {400}, closes},
       {"with a zero byte", line("GET /healthz" + zero() + " HTTP/1.1"), {400}, closes},
       {"with a control character", line("GET /heal\x01thz HTTP/1.1"), {400}, closes},
       {"with DEL", line("GET /healthz\x7f HTTP/1.1"), {400}, closes},
       {"of 8000 bytes", line("GET /" + std::string(7999, 'a') + " HTTP/1.1"), {404}},
       {"of 9000 bytes", line("GET /" + std::string(8999, 'a') + " HTTP/1.1"), {414}, closes},
       {"endless", "GET /" + std::string(20'000, 'a'), {414}, closes}}};
  for (const char c : std::string("\"<>[]\\^`{|}")) {
    group.cases.push_back(
        {std::string("with ") + c, line(std::string("GET /a") + c + " HTTP/1.1"), {400}, closes});
  }
  return group;
}

CaseGroup versions() {
  CaseGroup group{"Versions",  // RFC 9112, 2.3, and RFC 9110, 2.5
                  {{"1.0", line("GET /healthz HTTP/1.0"), {200}, closes},
                   {"1.2", line("GET /healthz HTTP/1.2"), {200}},
                   {"1.9", line("GET /healthz HTTP/1.9"), {200}},
                   {"2.0", line("GET /healthz HTTP/2.0"), {505}, closes},
                   {"0.9", line("GET /healthz HTTP/0.9"), {505}, closes},
                   {"3.0", line("GET /healthz HTTP/3.0"), {505}, closes},
                   {"the preface of HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", {505}, closes}}};
  for (const char* version :
       {"http/1.1", "Http/1.1", "HTTP/1", "HTTP/1.", "HTTP/1.10", "HTTP/11", "HTTP/01.1", "HTTP/1.a",
        "HTTP/ 1.1", "HTTP /1.1", "HTTPS/1.1", "HTTP/1,1", "HTTP-1.1", "1.1"}) {
    group.cases.push_back({version, line("GET /healthz " + std::string(version)), {400}, closes});
  }
  return group;
}

CaseGroup hosts() {
  CaseGroup group{
      "Host",  // RFC 9112, 3.2, and RFC 9110, 7.2
      {{"none", bare_get(""), {400}, closes},
       {"two", bare_get("Host: localhost\r\nHost: other\r\n"), {400}, closes},
       {"twice the same", bare_get("Host: localhost\r\nHost: localhost\r\n"), {400}, closes},
       {"twice, apart", bare_get("Host: localhost\r\nX: y\r\nhOST: localhost\r\n"), {400}, closes},
       {"none, in HTTP/1.0", "GET /healthz HTTP/1.0\r\n\r\n", {200}, closes},
       {"two, in HTTP/1.0", "GET /healthz HTTP/1.0\r\nHost: a\r\nHost: b\r\n\r\n", {400}, closes},
       {"in other letters", bare_get("hOsT: localhost\r\n"), {200}}}};
  for (const char* host : {"localhost:8080", "localhost:", "LOCALHOST", "127.0.0.1", "127.0.0.1:80", "[::1]",
                           "[::1]:8080", "a.example.", "a_b", "loc%61lhost"}) {
    group.cases.push_back(
        {std::string("a good one: ") + host, bare_get("Host: " + std::string(host) + "\r\n"), {200}});
  }
  for (const char* host : {"",
                           ":80",
                           "local host",
                           "local\thost",
                           "localhost/",
                           "localhost/healthz",
                           "me@localhost",
                           "localhost:x",
                           "localhost:-1",
                           "localhost:65536",
                           "localhost:80:80",
                           "localhost: 80",
                           "::1",
                           "[::1",
                           "[::zz]",
                           "[::1]x",
                           "[]",
                           "a, b",
                           "http://localhost",
                           "<script>",
                           "a\"b",
                           "a%zz",
                           "a\\b",
                           "loc\xc3\xa4lhost",
                           "a?b",
                           "a#b"}) {
    group.cases.push_back(
        {std::string("a bad one: ") + host, bare_get("Host: " + std::string(host) + "\r\n"), {400}, closes});
  }
  return group;
}

CaseGroup fields() {
  CaseGroup group{
      "Fields",  // RFC 9112, 5, and RFC 9110, 5
      {{"a blank before the colon", get("X : a\r\n"), {400}, closes},
       {"a tab before the colon", get("X\t: a\r\n"), {400}, closes},
       {"no colon", get("X\r\n"), {400}, closes},
       {"no name", get(": a\r\n"), {400}, closes},
       {"a blank within the name", get("X Y: a\r\n"), {400}, closes},
       {"a zero byte in the name", get("X" + zero() + "Y: a\r\n"), {400}, closes},
       {"a control character in the name", get("X\x01: a\r\n"), {400}, closes},
       {"a name beyond ASCII", get("X\xc3\xa4: a\r\n"), {400}, closes},
       {"a name of all signs", get("!#$%&'*+-.^_`|~0aZ: a\r\n"), {200}},
       {"an empty value", get("X:\r\n"), {200}},
       {"a value of blanks", get("X: \t \r\n"), {200}},
       {"no blank before the value", get("X-Request-Id:abc\r\n"), {200}, goes_on, "X-Request-Id: abc\r\n"},
       {"blanks around the value",
        get("X-Request-Id: \t abc\t \r\n"),
        {200},
        goes_on,
        "X-Request-Id: abc\r\n"},
       {"a name in other letters", get("x-rEQUEST-id: abc\r\n"), {200}, goes_on, "X-Request-Id: abc\r\n"},
       {"a percent sign in a value says nothing",
        get("X-Request-Id: a%41%0d%0ab\r\n"),
        {200},
        goes_on,
        "X-Request-Id: a%41%0d%0ab\r\n"},
       {"a tab within the value", get("X: a\tb\r\n"), {200}},
       {"a value beyond ASCII", get("X: \xc3\xa4\xff\r\n"), {200}},
       {"a value with a colon", get("X: a: b\r\n"), {200}},
       {"a zero byte in the value", get("X: a" + zero() + "b\r\n"), {400}, closes},
       {"a folded value", get("X: a\r\n b\r\n"), {400}, closes},
       {"a value folded by a tab", get("X: a\r\n\tb\r\n"), {400}, closes},
       {"a folded empty value", get("X:\r\n b\r\n"), {400}, closes},
       {"a line of blanks", get("X: a\r\n \r\n"), {400}, closes},
       {"a hundred", get(repeated(100, "X: a\r\n")), {200}},
       {"a thousand", get(repeated(1000, "X: a\r\n")), {431}, closes},
       {"a value of 8000 bytes", get("X: " + std::string(8000, 'a') + "\r\n"), {200}},
       {"a value of 20 000 bytes", get("X: " + std::string(20'000, 'a') + "\r\n"), {431}, closes},
       {"an endless name", bare_get(std::string(20'000, 'a')), {431}, closes}}};
  for (const char c : std::string("\"(),/;<=>?@[\\]{}")) {
    group.cases.push_back(
        {std::string("a name with ") + c, get(std::string("X") + c + "Y: a\r\n"), {400}, closes});
  }
  for (const char c : std::string("\x01\x08\x0b\x0c\x0e\x1b\x1f\x7f")) {
    group.cases.push_back({"a value with character " + std::to_string(c),
                           get(std::string("X: a") + c + "b\r\n"),
                           {400},
                           closes});
  }
  return group;
}

CaseGroup lengths() {
  CaseGroup group{
      "ContentLength",  // RFC 9112, 6.2 and 6.3, and RFC 9110, 8.6
      {{"of the body", post("Content-Length: 2\r\n", "{}"), {422}},
       {"with blanks around", post("Content-Length:\t 2 \r\n", "{}"), {422}},
       {"with a leading zero", post("Content-Length: 002\r\n", "{}"), {422}},
       {"in other letters", post("cONTENT-lENGTH: 2\r\n", "{}"), {422}},
       {"none, so there is no body", post("", ""), {400}},
       {"of nothing", post("Content-Length: 0\r\n", ""), {400}},
       {"of a request within", sized(get()), {400}},
       {"of a body nobody asked for", get("Content-Length: 44\r\n") + std::string(44, 'x'), {200}},
       {"of a body to a path that is none", post("Content-Length: 2\r\n", "{}", "/nothing"), {404}},
       {"of a body to be deleted",
        "DELETE /v1/solves/x HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}",
        {404}},
       {"of a body with HEAD",
        "HEAD /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}",
        {200}},
       {"twice the same", post("Content-Length: 2\r\nContent-Length: 2\r\n", "{}"), {400}, closes},
       {"two", post("Content-Length: 2\r\nContent-Length: 3\r\n", "{}"), {400}, closes},
       {"two, and the longer first", post("Content-Length: 3\r\nContent-Length: 2\r\n", "{}"), {400}, closes},
       {"with chunks",
        post("Content-Length: 2\r\nTransfer-Encoding: chunked\r\n", "2\r\n{}\r\n0\r\n\r\n"),
        {400},
        closes},
       {"after chunks",
        post("Transfer-Encoding: chunked\r\nContent-Length: 2\r\n", "2\r\n{}\r\n0\r\n\r\n"),
        {400},
        closes},
       {"folded", post("Content-Length:\r\n 2\r\n", "{}"), {400}, closes},
       {"with a blank before the colon", post("Content-Length : 2\r\n", "{}"), {400}, closes},
       {"beyond the limit", post("Content-Length: 1048577\r\n", ""), {413}, closes},
       {"beyond all limits", post("Content-Length: 9223372036854775808\r\n", ""), {413}, closes},
       {"in HTTP/1.0",
        "POST /v1/validate HTTP/1.0\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}",
        {422},
        closes}}};
  for (const char* length : {"",
                             "+2",
                             "-2",
                             "-0",
                             "0x2",
                             "2 2",
                             "2,2",
                             "2, 2",
                             "2, 3",
                             "2,",
                             "two",
                             "2.0",
                             "2;",
                             "2e0",
                             "2x",
                             "\"2\"",
                             "%32",
                             "%31%30%30%30",
                             "18446744073709551616",
                             "99999999999999999999999",
                             "2\v",
                             "\xd9\xa2"}) {
    group.cases.push_back({std::string("a bad one: ") + length,
                           post("Content-Length: " + std::string(length) + "\r\n", "{}"),
                           {400},
                           closes});
  }
  return group;
}

CaseGroup codings() {
  const std::string body = "2\r\n{}\r\n0\r\n\r\n";
  CaseGroup group{
      "TransferEncoding",  // RFC 9112, 6.1 and 6.3, and RFC 9110, 5.6.1
      {{"chunked", post("Transfer-Encoding: chunked\r\n", body), {422}},
       {"in other letters", post("tRANSFER-eNCODING: Chunked\r\n", body), {422}},
       {"in capitals", post("Transfer-Encoding: CHUNKED\r\n", body), {422}},
       {"with blanks around", post("Transfer-Encoding: \tchunked \r\n", body), {422}},
       {"with an empty element after", post("Transfer-Encoding: chunked, \r\n", body), {422}},
       {"another before", post("Transfer-Encoding: gzip, chunked\r\n", body), {501}, closes},
       {"another before, in two lines",
        post("Transfer-Encoding: gzip\r\nTransfer-Encoding: chunked\r\n", body),
        {501},
        closes},
       {"an unknown one before", post("Transfer-Encoding: foo, chunked\r\n", body), {501}, closes},
       {"identity before", post("Transfer-Encoding: identity, chunked\r\n", body), {501}, closes},
       {"twice, in two lines",
        post("Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", body),
        {400},
        closes},
       {"and another, in two lines",
        post("Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n", body),
        {400},
        closes},
       {"with a blank before the colon", post("Transfer-Encoding : chunked\r\n", body), {400}, closes},
       {"folded", post("Transfer-Encoding:\r\n chunked\r\n", body), {400}, closes},
       {"in HTTP/1.0",
        "POST /v1/validate HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n" + body,
        {400},
        closes},
       {"of a body nobody asked for", get("Transfer-Encoding: chunked\r\n") + body, {200}}}};
  for (const std::string& coding :
       {std::string(), std::string("gzip"), std::string("identity"), std::string("chunked, gzip"),
        std::string("chunked, chunked"), std::string("chunked, identity"), std::string("xchunked"),
        std::string("chunkedx"), std::string("chunked;q=1"), std::string("chunked; foo=bar"),
        std::string("'chunked'"), std::string("\"chunked\""), std::string("chun ked"),
        std::string("chunke%64"), std::string("\vchunked"), "chunked" + zero(), std::string(","),
        std::string("chunked\f")}) {
    group.cases.push_back(
        {"a bad one: " + coding, post("Transfer-Encoding: " + coding + "\r\n", body), {400}, closes});
  }
  return group;
}

CaseGroup chunks() {
  CaseGroup group{
      "Chunks",  // RFC 9112, 7.1
      {{"two", chunked("1\r\n{\r\n1\r\n}\r\n0\r\n\r\n"), {422}},
       {"none", chunked("0\r\n\r\n"), {400}},
       {"a size with zeros before", chunked("0002\r\n{}\r\n000\r\n\r\n"), {422}},
       {"a size in small letters", chunked("a\r\n{        }\r\n0\r\n\r\n"), {422}},
       {"a size in capitals", chunked("A\r\n{        }\r\n0\r\n\r\n"), {422}},
       {"with an extension", chunked("2;a=b\r\n{}\r\n0\r\n\r\n"), {422}},
       {"with an extension without a value", chunked("2;a\r\n{}\r\n0\r\n\r\n"), {422}},
       {"with two extensions", chunked("2;a=b;c=d\r\n{}\r\n0\r\n\r\n"), {422}},
       {"with a quoted extension", chunked("2;a=\"b;c\\\"\"\r\n{}\r\n0\r\n\r\n"), {422}},
       {"with blanks around an extension", chunked("2 ; a = b\r\n{}\r\n0\r\n\r\n"), {422}},
       {"with an extension at the end", chunked("2\r\n{}\r\n0;a=b\r\n\r\n"), {422}},
       {"with a trailer", chunked("2\r\n{}\r\n0\r\nX: a\r\n\r\n"), {422}},
       {"with trailers", chunked("2\r\n{}\r\n0\r\nX: a\r\nY: b\r\nDigest: c\r\n\r\n"), {422}},
       {"with a trailer that must be none",
        chunked("2\r\n{}\r\n0\r\nHost: other\r\nX-Request-Id: t\r\n\r\n"),
        {422}},
       {"with a folded trailer", chunked("2\r\n{}\r\n0\r\nX: a\r\n b\r\n\r\n"), {400}, closes},
       {"with a trailer folded by a tab", chunked("2\r\n{}\r\n0\r\nX: a\r\n\tb\r\n\r\n"), {400}, closes},
       {"with a folded trailer after another",
        chunked("2\r\n{}\r\n0;a=b\r\nX: a\r\nY: b\r\n \r\n\r\n"),
        {400},
        closes},
       {"with a trailer that begins with a blank", chunked("2\r\n{}\r\n0\r\n X: a\r\n\r\n"), {400}, closes},
       {"with a folded trailer, of which the end is missing",
        chunked("2\r\n{}\r\n0\r\nX: a\r\n b"),
        {400},
        closes},
       {"with a trailer that is none", chunked("2\r\n{}\r\n0\r\nX a\r\n\r\n"), {400}, closes},
       {"with a trailer with a zero byte",
        chunked("2\r\n{}\r\n0\r\nX: " + zero() + "\r\n\r\n"),
        {400},
        closes},
       {"with a trailer ended by a line feed", chunked("2\r\n{}\r\n0\r\nX: a\n\r\n"), {400}, closes},
       {"with countless trailers",
        chunked("2\r\n{}\r\n0\r\n" + repeated(200, "X: a\r\n") + "\r\n"),
        {431},
        closes},
       {"with a long trailer", chunked("2\r\n{}\r\n0\r\nX: " + std::string(20'000, 'a')), {431}, closes},
       {"that hold a last chunk", chunked("7\r\n0\r\n\r\n{}\r\n0\r\n\r\n"), {400}},
       {"with an endless extension", chunked("2;a=" + std::string(20'000, 'a')), {400}, closes},
       {"no end of line after the data", chunked("2\r\n{}0\r\n\r\n"), {400}, closes},
       {"a line feed alone after the data", chunked("2\r\n{}\n0\r\n\r\n"), {400}, closes},
       {"a line feed alone after the size", chunked("2\n{}\r\n0\r\n\r\n"), {400}, closes},
       {"line feeds alone", chunked("2\n{}\n0\n\n"), {400}, closes},
       {"a carriage return alone after the size", chunked("2\r{}\r\n0\r\n\r\n"), {400}, closes},
       {"data longer than the size", chunked("1\r\n{}\r\n0\r\n\r\n"), {400}, closes},
       {"data shorter than the size", chunked("3\r\n{}\r\n0\r\n\r\n"), {400}, closes},
       {"a blank line for a size", chunked("\r\n{}\r\n0\r\n\r\n"), {400}, closes},
       {"beyond the limit", chunked("100001\r\n"), {413}, closes},
       {"beyond all limits", chunked("7fffffffffffffff\r\n"), {413}, closes},
       {"beyond the limit together", chunked("2\r\n{}\r\nfffff\r\n"), {413}, closes}}};
  for (const std::string& size : {std::string("-2"),
                                  std::string("+2"),
                                  std::string(" 2"),
                                  std::string("\t2"),
                                  std::string("2 "),
                                  std::string("2\t"),
                                  std::string("0x2"),
                                  std::string("x2"),
                                  std::string("2x"),
                                  std::string("g"),
                                  std::string("2,"),
                                  std::string("2.0"),
                                  std::string("2h"),
                                  std::string("-0"),
                                  "2" + zero(),
                                  std::string("2;\x01=b"),
                                  std::string("2;a=\x01"),
                                  std::string("2;a=\"\x01\""),
                                  std::string("2;"),
                                  std::string("2;=b"),
                                  std::string("2;a="),
                                  std::string("2;a=\"b"),
                                  std::string("2 a"),
                                  std::string("10000000000000000"),
                                  std::string("fffffffffffffffff"),
                                  std::string("%32")}) {
    group.cases.push_back({"a bad size: " + size, chunked(size + "\r\n{}\r\n0\r\n\r\n"), {400}, closes});
  }
  return group;
}

CaseGroup connections() {
  const std::string list = line("GET /v1/solves HTTP/1.1");
  return {
      "Connections",  // RFC 9112, 9
      {{"kept", get(), {200}},
       {"kept, as asked", get("Connection: keep-alive\r\n"), {200}},
       {"with an option of no meaning", get("Connection: foo\r\nFoo: bar\r\n"), {200}},
       {"with an empty list of options", get("Connection:\r\n"), {200}},
       {"close", get("Connection: close\r\n"), {200}, closes},
       {"close, in capitals", get("Connection: CLOSE\r\n"), {200}, closes},
       {"close, in mixed letters", get("connection: Close\r\n"), {200}, closes},
       {"close, in a list", get("Connection: TE, close\r\n"), {200}, closes},
       {"close, first in a list", get("Connection: close,TE\r\n"), {200}, closes},
       {"close, in a second line", get("Connection: keep-alive\r\nConnection: close\r\n"), {200}, closes},
       {"closed by HTTP/1.0", "GET /healthz HTTP/1.0\r\n\r\n", {200}, closes},
       {"closed by HTTP/1.0, though asked otherwise",
        "GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n",
        {200},
        closes},
       {"nothing after the last request", get("Connection: close\r\n") + get(), {200}, closes},
       {"three at once", get() + list + get(), {200, 200, 200}},
       {"many at once", repeated(20, get()), std::vector<int>(20, 200)},
       {"a body, and the next at once", post("Content-Length: 2\r\n", "{}") + get(), {422, 200}},
       {"an empty line between", post("Content-Length: 2\r\n", "{}") + "\r\n" + get(), {422, 200}},
       {"chunks, and the next at once", chunked("2\r\n{}\r\n0\r\n\r\n") + get(), {422, 200}},
       {"chunks with a trailer, and the next at once",
        chunked("2\r\n{}\r\n0\r\nX: a\r\n\r\n") + get(),
        {422, 200}},
       {"a body nobody reads, and the next at once",
        post("Content-Length: 2\r\n", "{}", "/nothing") + get(),
        {404, 200}},
       {"HEAD, and the next at once", line("HEAD /healthz HTTP/1.1") + get(), {200, 200}},
       {"HTTP/1.2, and the next at once", line("GET /healthz HTTP/1.2") + get(), {200, 200}},
       {"nonsense after a request", get() + "nonsense\r\n\r\n", {200, 400}, closes},
       {"a bad request, and nothing after it", get("X : a\r\n") + get(), {400}, closes},
       {"another protocol is not switched to", get("Connection: Upgrade\r\nUpgrade: websocket\r\n"), {200}},
       {"nor HTTP/2",
        get("Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABk\r\n"),
        {200}}}};
}

CaseGroup expectations() {
  const std::string expect = "Expect: 100-continue\r\n";
  return {
      "Expectations",  // RFC 9110, 10.1.1
      {{"100-continue", post(expect + "Content-Length: 2\r\n", ""), {100, 422}, goes_on, "", "{}"},
       {"100-continue, in other letters",
        post("eXPECT: 100-Continue\r\nContent-Length: 2\r\n", ""),
        {100, 422},
        goes_on,
        "",
        "{}"},
       {"100-continue with chunks",
        post(expect + "Transfer-Encoding: chunked\r\n", ""),
        {100, 422},
        goes_on,
        "",
        "2\r\n{}\r\n0\r\n\r\n"},
       {"100-continue with a long body",
        post(expect + "Content-Length: 100000\r\n", ""),
        {100, 422},
        goes_on,
        "",
        "{}" + std::string(99'998, ' ')},
       {"the body has come already", post(expect + "Content-Length: 2\r\n", "{}"), {422}},
       {"there is no body", get(expect), {200}},
       {"a body of nothing", post(expect + "Content-Length: 0\r\n", ""), {400}},
       {"in HTTP/1.0 it says nothing",
        "POST /v1/validate HTTP/1.0\r\nContent-Type: application/json\r\n" + expect +
            "Content-Length: 2\r\n\r\n{}",
        {422},
        closes},
       {"something else", post("Expect: 200-ok\r\nContent-Length: 2\r\n", "{}"), {417}, closes},
       {"something else too",
        post("Expect: 100-continue, foo\r\nContent-Length: 2\r\n", "{}"),
        {417},
        closes},
       {"something else, without a body", get("Expect: foo=bar\r\n"), {417}, closes},
       {"nothing", get("Expect:\r\n"), {200}},
       {"no 100 before 413", post(expect + "Content-Length: 1048577\r\n", ""), {413}, closes},
       {"no 100 before 404", post(expect + "Content-Length: 2\r\n", "", "/nothing"), {404}, closes},
       {"no 100 before 405", post(expect + "Content-Length: 2\r\n", "", "/healthz"), {405}, closes},
       {"no 100 before 406", post(expect + "Accept: text/html\r\nContent-Length: 2\r\n", ""), {406}, closes},
       {"no 100 before 415",
        typed(expect + "Content-Type: text/plain\r\nContent-Length: 2\r\n"),
        {415},
        closes},
       {"no 100 before 415 without a type", typed(expect + "Content-Length: 2\r\n"), {415}, closes},
       {"no 100 before 415 of a study",
        typed(expect + "Content-Type: text/plain\r\nContent-Length: 2\r\n", "/v1/studies"),
        {415},
        closes},
       {"no 100 before 415 of a coding",
        post(expect + "Content-Encoding: br\r\nContent-Length: 2\r\n", ""),
        {415},
        closes,
        "\r\nAccept-Encoding: gzip, deflate\r\n"},
       {"no 100 before 415 of two codings",
        post(expect + "Content-Encoding: gzip, gzip\r\nContent-Length: 2\r\n", "", "/v1/solves"),
        {415},
        closes},
       {"no 100 before 415 of chunks",
        typed(expect + "Content-Type: text/plain\r\nTransfer-Encoding: chunked\r\n"),
        {415},
        closes},
       {"a long body of another type is not waited for",
        typed("Content-Type: text/plain\r\nContent-Length: 100000\r\n"),
        {415},
        closes},
       {"a long body of an unknown coding is not waited for",
        post("Content-Encoding: br\r\nContent-Length: 100000\r\n", ""),
        {415},
        closes},
       {"no 100 before 400", post(expect + "Content-Length: x\r\n", ""), {400}, closes},
       {"no 100 before 501", post(expect + "Transfer-Encoding: gzip, chunked\r\n", ""), {501}, closes},
       {"a long body is not waited for in vain",
        post("Content-Length: 100000\r\n", "", "/nothing"),
        {404},
        closes}}};
}

CaseGroup contents() {
  const std::string whole = gzipped("{}");
  return {
      "Contents",  // RFC 9110, 8 and 12 to 15
      {{"gzip", coded("gzip", whole), {422}},
       {"x-gzip", coded("x-gzip", whole), {422}},
       {"gzip in capitals", coded("GZIP", whole), {422}},
       {"gzip of two members", coded("gzip", gzipped("{") + gzipped("}")), {422}},
       {"deflate", coded("deflate", deflated()), {422}},
       {"identity", coded("identity", "{}"), {422}},
       {"gzip without its end", coded("gzip", whole.substr(0, whole.size() - 8)), {400}},
       {"gzip without its last byte", coded("gzip", whole.substr(0, whole.size() - 1)), {400}},
       {"gzip with its head only", coded("gzip", whole.substr(0, 10)), {400}},
       {"gzip of nothing", coded("gzip", ""), {400}},
       {"gzip with another sum",
        coded("gzip", whole.substr(0, whole.size() - 8) + std::string(8, '\1')),
        {400}},
       {"gzip with something after it", coded("gzip", whole + "x"), {400}},
       {"deflate without its end", coded("deflate", deflated().substr(0, 10)), {400}},
       {"not gzip", coded("gzip", "{}"), {400}},
       {"br", coded("br", "{}"), {415}, goes_on, "\r\nAccept-Encoding: gzip, deflate\r\n"},
       {"gzip of a hundred times its length",
        coded("gzip", gzipped(std::string(1'000'000, ' ') + "{}")),
        {413}},
       {"gzip of blanks that any body may become",
        coded("gzip", gzipped(std::string(60'000, ' ') + "{}")),
        {422}},
       {"gzip twice", coded("gzip, gzip", gzipped(whole)), {415}},
       {"gzip in chunks",
        post("Content-Encoding: gzip\r\nTransfer-Encoding: chunked\r\n",
             [&] {
               std::string body;
               for (const char c : whole) body += "1\r\n" + std::string(1, c) + "\r\n";
               return body + "0\r\n\r\n";
             }()),
        {422}},
       {"no type", "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\n{}", {415}},
       {"a type in other letters",
        "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\ncontent-type: Application/JSON; "
        "charset=UTF-8\r\nContent-Length: 2\r\n\r\n{}",
        {422}},
       {"another type",
        "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/plain\r\nContent-Length: "
        "2\r\n\r\n{}",
        {415}},
       {"parts",
        "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: multipart/form-data; "
        "boundary=x\r\nContent-Length: 2\r\n\r\n{}",
        {415}},
       {"a range of bytes", get("Range: bytes=0-1\r\n"), {200}, goes_on, "{\"status\":\"ok\"}"},
       {"a range of something else", get("Range: lines=1-2\r\n"), {200}, goes_on, "{\"status\":\"ok\"}"},
       {"a range that is none", get("Range: bytes=abc\r\n"), {200}, goes_on, "{\"status\":\"ok\"}"},
       {"a range beyond the end", get("Range: bytes=1000-2000\r\n"), {200}, goes_on, "{\"status\":\"ok\"}"},
       {"a condition",
        get("If-None-Match: \"x\"\r\nIf-Modified-Since: Mon, 23 Nov 2026 05:00:00 GMT\r\n"),
        {200}},
       {"nothing that is accepted",
        "GET /v1/solves HTTP/1.1\r\nHost: localhost\r\nAccept: image/png\r\n\r\n",
        {406}},
       {"anything is accepted",
        "GET /v1/solves HTTP/1.1\r\nHost: localhost\r\nAccept: image/png, */*;q=0.1\r\n\r\n",
        {200}},
       {"gzip is accepted",
        "GET /openapi.json HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n",
        {200},
        goes_on,
        "\r\nContent-Encoding: gzip\r\n"},
       {"trailers are accepted", get("TE: trailers\r\nConnection: TE\r\n"), {200}},
       {"no more hops", get("Max-Forwards: 0\r\n"), {200}}}};
}

}  // namespace

std::vector<CaseGroup> case_groups() {
  return {lines(),  request_line(), methods(), refused_heads(), targets(),     versions(),     hosts(),
          fields(), lengths(),      codings(), chunks(),        connections(), expectations(), contents()};
}

}  // namespace signorini::server
