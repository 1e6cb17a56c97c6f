#include "live/page_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <random>
#include <thread>

#include "failure/failure.h"

namespace abbe::live {
namespace {

constexpr int kMostBrowsers = 12;
constexpr double kHeartbeat = 1.0;  // s, between signs of life
constexpr int kThreads = kMostBrowsers + 4;

// 128 bits of the system's randomness.
std::string Draw() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", device(), device(), device(), device());
}

bool IsLoopback(const std::string& address) {
  return address == "127.0.0.1" || address == "localhost" || address == "::1";
}

// Takes the same time wherever two texts differ.
bool Same(const std::string& one, const std::string& other) {
  if (one.size() != other.size()) return false;
  unsigned char differs = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    differs = static_cast<unsigned char>(differs | (one[i] ^ other[i]));
  }
  return differs == 0;
}

// The policy that the page states itself; a page without one may do nothing.
std::string PolicyOf(const std::string& page) {
  constexpr std::string_view kBefore = "Content-Security-Policy\" content=\"";
  const std::size_t begin = page.find(kBefore);
  if (begin == std::string::npos) return "default-src 'none'";
  const std::size_t from = begin + kBefore.size();
  return page.substr(from, page.find('"', from) - from);
}

std::string Host(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

}  // namespace

class PageServer::Http {
 public:
  Http(EventLog& log, std::string page, const PageServerOptions& options)
      : log_(log), page_(std::move(page)), options_(options), session_(Draw().substr(0, 12)) {
    const std::size_t mark = page_.find(kSessionMark);
    if (mark != std::string::npos) page_.replace(mark, std::strlen(kSessionMark), session_);
    if (!IsLoopback(options.bind)) token_ = Draw();
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server_.set_keep_alive_timeout(2);
    // Not SO_REUSEPORT, which lets two servers share a port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    Route();
    Listen();
  }

  ~Http() {
    // Each stream ends properly within a sign of life; a browser that hangs is left.
    log_.Close();
    for (int i = 0; i < 100 && browsers_ > 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }

  std::string Url() const {
    return fmt::format("http://{}:{}/{}", Host(options_.bind), port_,
                       token_.empty() ? "" : "?token=" + token_);
  }

  void Drain(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    // A sign of life has found the browser behind.
    while (behind_ > 0 && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

 private:
  void Listen() {
    errno = 0;
    const bool bound = options_.port == 0
                           ? (port_ = server_.bind_to_any_port(options_.bind)) > 0
                           : server_.bind_to_port(options_.bind, port_ = options_.port);
    if (!bound) {
      const int why = errno;
      throw DeviceError(fmt::format(
          "--live: cannot listen on {} port {}: {}; {}", options_.bind, options_.port,
          why == 0 ? "no such address" : std::strerror(why),
          why == EADDRINUSE ? "end the other program, or choose another with --live-port"
                            : "give --live-bind an address of this computer"));
    }
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  void Route() {
    server_.set_default_headers(
        {{"Content-Security-Policy", PolicyOf(page_) + "; base-uri 'none'; form-action 'none'; "
                                                       "frame-ancestors 'none'"},
         {"X-Content-Type-Options", "nosniff"},
         {"X-Frame-Options", "DENY"},
         {"Referrer-Policy", "no-referrer"},
         {"Cache-Control", "no-store"}});
    server_.set_pre_routing_handler([this](const auto& request, auto& response) {
      if (Permitted(request)) return httplib::Server::HandlerResponse::Unhandled;
      response.status = 403;
      response.set_content(
          "This address lacks the token, or is not this server's: use the one "
          "that abbe printed.\n",
          "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Get("/", [this](const auto&, auto& response) {
      // Not set_content(), which compresses five megabytes as well as it can: half a minute.
      response.set_content_provider(
          page_.size(), "text/html; charset=utf-8",
          [this](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            return sink.write(page_.data() + offset, length);
          });
    });
    server_.Get("/events",
                [this](const auto& request, auto& response) { Events(request, response); });
    server_.Get("/favicon.ico", [](const auto&, auto& response) { response.status = 204; });
  }

  bool Permitted(const httplib::Request& request) const {
    if (!token_.empty()) return Same(request.get_param_value("token"), token_);
    // A name that somebody else resolves to this computer is not its own.
    std::string host = request.get_header_value("Host");
    const std::string port = fmt::format(":{}", port_);
    if (!host.ends_with(port)) return false;
    host.resize(host.size() - port.size());
    return host == "[::1]" || IsLoopback(host);
  }

  // The number of the last event that the browser has seen in this session.
  std::uint64_t SeenBy(const httplib::Request& request) const {
    const std::string last = request.get_header_value("Last-Event-ID");
    if (!last.starts_with(session_ + "-")) return 0;
    std::uint64_t seen = 0;
    std::from_chars(last.data() + session_.size() + 1, last.data() + last.size(), seen);
    return seen;
  }

  void Events(const httplib::Request& request, httplib::Response& response) {
    if (browsers_.fetch_add(1) >= kMostBrowsers) {
      --browsers_;
      response.status = 503;
      response.set_content(fmt::format("{} browsers are looking already.\n", kMostBrowsers),
                           "text/plain");
      return;
    }
    const auto seen = std::make_shared<std::uint64_t>(SeenBy(request));
    const auto greeted = std::make_shared<bool>(false);
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, seen, greeted](std::size_t, httplib::DataSink& sink) {
          return Send(*seen, *greeted, sink);
        },
        [this, greeted](bool) {
          --browsers_;
          if (*greeted) --greeted_;
        });
  }

  bool Send(std::uint64_t& seen, bool& greeted, httplib::DataSink& sink) {
    std::string text;
    if (!greeted) {
      text = fmt::format(
          "retry: 500\nevent: hello\ndata: {{\"session\":\"{}\",\"version\":\"{}\"}}\n\n", session_,
          options_.version);
      greeted = true;
      ++greeted_;
    }
    const auto events = log_.After(seen, text.empty() ? kHeartbeat : 0.0);
    if (!events.empty()) ++behind_;
    for (const auto& event : events) {
      text += fmt::format("id: {}-{}\nevent: {}\ndata: {}\n\n", session_, event->id, event->name,
                          event->data);
      seen = event->id;
    }
    if (text.empty()) text = ": still here\n\n";
    const bool sent = sink.write(text.data(), text.size());
    if (!events.empty()) --behind_;
    if (sent && events.empty() && log_.closed()) {
      sink.done();
      return true;
    }
    return sent;
  }

  EventLog& log_;
  std::string page_;
  const PageServerOptions options_;
  const std::string session_;
  std::string token_;
  int port_ = 0;
  std::atomic<int> browsers_ = 0, greeted_ = 0, behind_ = 0;
  httplib::Server server_;
  std::thread thread_;
};

PageServer::PageServer(EventLog& log, std::string page, const PageServerOptions& options)
    : http_(std::make_unique<Http>(log, std::move(page), options)) {
  url_ = http_->Url();
}

PageServer::~PageServer() = default;

void PageServer::Drain(double seconds) { http_->Drain(seconds); }

}  // namespace abbe::live
