// The server and the client against each other, and the server against sockets that behave badly.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "core/errors.h"
#include "core/http_client.h"
#include "core/http_server.h"

namespace isoline {
namespace {

constexpr const char* kHost = "127.0.0.1";
constexpr HttpLimits kTight{.head_bytes = 4096,
                            .body_bytes = 1000,
                            .idle_seconds = 0.3,
                            .request_seconds = 1,
                            .connections = 4};

std::string refusal(int status, const std::string& reason) {
  return "refused " + std::to_string(status) + " " + reason;
}

std::vector<HttpRoute> routes() {
  return {{"GET", "/name",
           [](const std::string&) {
             return HttpReply{200, "echo"};
           }},
          {"POST", "/echo",
           [](const std::string& body) {
             return HttpReply{200, body};
           }},
          {"POST", "/fail", [](const std::string&) -> HttpReply { throw UsageError("no"); }}};
}

class Http : public testing::Test {
 protected:
  Http() { server.start(); }
  HttpReply post(const std::string& path, const std::string& body) {
    return HttpClient(server.url(), 10, 1 << 20).post(path, body);
  }

  HttpServer server{kHost, 0, routes(), refusal, kTight};
};

// A connection that says what it is told to.
class Caller {
 public:
  explicit Caller(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, kHost, &at.sin_addr);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  }
  ~Caller() { ::close(socket_); }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  bool say(const std::string& text) {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }
  // All that comes until the server closes.
  std::string hear() {
    std::string all;
    char chunk[4096];
    for (ssize_t got; (got = ::recv(socket_, chunk, sizeof chunk, 0)) > 0;)
      all.append(chunk, static_cast<std::size_t>(got));
    return all;
  }

 private:
  int socket_;
};

TEST_F(Http, AnswersWhatIsAsked) {
  HttpClient client(server.url(), 10, 1 << 20);
  EXPECT_EQ(client.get("/name").body, "echo");
  for (const std::string body : {"", "{}", "two\nlines"}) {
    const HttpReply reply = client.post("/echo", body);
    EXPECT_EQ(reply.status, 200);
    EXPECT_EQ(reply.body, body);
  }
}

TEST_F(Http, RefusesInItsCallersWords) {
  EXPECT_EQ(post("/nowhere", "{}").body, "refused 404 ");
  EXPECT_EQ(post("/name", "{}").status, 404) << "that is asked by GET";
  EXPECT_EQ(post("/fail", "{}").body, "refused 500 no");
  const HttpReply long_one = post("/echo", std::string(kTight.body_bytes + 1, 'x'));
  EXPECT_EQ(long_one.status, 413);
  EXPECT_EQ(long_one.body.substr(0, 11), "refused 413");
  EXPECT_EQ(post("/echo", std::string(kTight.body_bytes, 'x')).status, 200);
}

TEST_F(Http, AnswersTheNextOneAfterARefusal) {
  HttpClient client(server.url(), 10, 1 << 20);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(client.post("/nowhere", "{\"some\": \"body\"}").status, 404);
    EXPECT_EQ(client.post("/echo", "again").body, "again");
  }
}

TEST_F(Http, AChunkedBodyIsHeldToTheSameBytes) {
  const std::string head = "POST /echo HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  Caller good(server.port());
  ASSERT_TRUE(good.say(head + "5\r\nhello\r\n0\r\n\r\n"));
  EXPECT_NE(good.hear().find("hello"), std::string::npos);
  Caller endless(server.port());
  ASSERT_TRUE(endless.say(head));
  const std::string chunk = "200\r\n" + std::string(0x200, 'x') + "\r\n";
  for (int i = 0; i < 20 && endless.say(chunk); ++i) {
  }
  EXPECT_NE(endless.hear().find("refused 413"), std::string::npos);
}

TEST_F(Http, WhatIsNoRequestIsAnsweredAndLetGo) {
  const std::string gigantic(1 << 16, 'a');
  for (const std::string& text :
       {std::string("\x16\x03\x01 nonsense\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("POST /echo HTTP/9.9\r\n\r\n"), "GET /" + gigantic + " HTTP/1.1\r\n\r\n",
        "GET /name HTTP/1.1\r\nX: " + gigantic + "\r\n\r\n",
        std::string("POST /echo HTTP/1.1\r\nContent-Type: multipart/form-data; boundary=x\r\n"
                    "Content-Length: 0\r\n\r\n")}) {
    Caller caller(server.port());
    caller.say(text);
    const std::string heard = caller.hear();
    EXPECT_TRUE(heard.empty() || heard.find("HTTP/1.1 4") == 0) << text.substr(0, 40) << heard;
  }
  EXPECT_EQ(post("/echo", "still there").body, "still there");
}

TEST_F(Http, ABodyThatNeverComesIsGivenUp) {
  for (const char* length : {"900", "18446744073709551615", "99999999999999999999999"}) {
    Caller caller(server.port());
    ASSERT_TRUE(caller.say(std::string("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: ") +
                           length + "\r\n\r\nhalf"));
    EXPECT_EQ(caller.hear().find("HTTP/1.1 4"), 0U) << length;
  }
}

TEST_F(Http, ACallerWhoDripsIsHeldToTheWholeTime) {
  Caller caller(server.port());
  ASSERT_TRUE(caller.say("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 900\r\n\r\n"));
  constexpr int kPause = 100;  // milliseconds, less than what is idle
  int said = 0;
  while (said < 100 && caller.say("x")) {
    ++said;
    ::poll(nullptr, 0, kPause);
    if (said > 20) break;  // twice the time that a request has
  }
  EXPECT_EQ(caller.hear().find("HTTP/1.1 400"), 0U);
}

TEST_F(Http, SilentCallersDoNotKeepItFromStopping) {
  Caller silent(server.port()), half(server.port());
  ASSERT_TRUE(half.say("POST /echo HT"));
  server.stop();  // returns
  EXPECT_THROW(post("/echo", ""), HttpFailure);
}

TEST_F(Http, ServesSeveralCallersAtATime) {
  std::atomic<int> good = 0;
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i)
    callers.emplace_back([&, i] {
      HttpClient client(server.url(), 10, 1 << 20);
      for (int j = 0; j < 50; ++j) {
        const std::string body = std::to_string(1000 * i + j);
        good += client.post("/echo", body).body == body;
      }
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(good, 8 * 50);
}

TEST_F(Http, AnAnswerLongerThanAllowedIsAFailure) {
  HttpClient client(server.url(), 10, 100);
  EXPECT_EQ(client.post("/echo", std::string(100, 'x')).body.size(), 100U);
  EXPECT_THROW(client.post("/echo", std::string(101, 'x')), HttpFailure);
}

TEST(HttpClients, SayWhatFails) {
  int port = 0;
  {
    const HttpServer bound(kHost, 0, {}, refusal, {});
    port = bound.port();
  }
  try {
    HttpClient("http://127.0.0.1:" + std::to_string(port), 1, 100).get("/name");
    FAIL();
  } catch (const HttpFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("nobody listens there"), std::string::npos);
  }
  for (const char* url : {"", "127.0.0.1", "https://x", "http://", "http://x:0", "http://x:99999",
                          "http://x:1y", "http://[::1"})
    EXPECT_THROW(HttpClient(url, 1, 100), UsageError) << url;
}

TEST(HttpServers, APortThatIsTakenIsTheCallersMistake) {
  const HttpServer one(kHost, 0, {}, refusal, {});
  EXPECT_THROW(HttpServer("999.1.1.1", 0, {}, refusal, {}), UsageError);
}

}  // namespace
}  // namespace isoline
