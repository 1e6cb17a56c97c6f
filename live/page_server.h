// Serves the live page and its events over HTTP (cpp-httplib).
//
//   PageServer server(log, page, {.bind = "127.0.0.1", .port = 0});
//   fmt::print("{}\n", server.url());
//
//   GET /        the page: HTML without results; it asks for
//   GET /events  Server-Sent Events of the log; each has the id SESSION-NUMBER. With Last-Event-ID
//                only what came after it; of another session all, after the event "hello" which says
//                the session and the version, so that a page of another server knows.
//
// One way: nothing that a browser sends changes anything. Bound to the loopback interface unless
// another address is given; there, only requests that name this server as their host are answered.
// Bound elsewhere, each address carries a token that is drawn when the server starts. Headers
// forbid the page any source but itself and its own connection.
// Threads: one for each browser, up to 12; a further one gets 503.
// Failure: DeviceError when the port is taken or the address is none of this computer's.
#pragma once

#include <memory>
#include <string>

#include "live/event_log.h"

namespace abbe::live {

struct PageServerOptions {
  std::string bind = "127.0.0.1";
  int port = 0;  // 0: a free one
  std::string version = {};
};

class PageServer {
 public:
  // The page contains `session_mark` where the session is to stand. `log` must outlive the server.
  PageServer(EventLog& log, std::string page, const PageServerOptions& options);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  const std::string& url() const { return url_; }
  // Returns when every browser has all events of the log, or after `seconds`.
  void Drain(double seconds);

 private:
  class Http;
  std::string url_;
  std::unique_ptr<Http> http_;
};

inline constexpr const char* kSessionMark = "@@session@@";

}  // namespace abbe::live
