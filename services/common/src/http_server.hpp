// Answers HTTP GET requests for one path, in a thread of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace topogeo::service {

struct HttpPage {
  std::string path;
  std::string content_type;
  std::function<std::string()> body;  ///< called in the thread of the server
};

class HttpServer {
 public:
  /// Port 0: any free one. Throws std::runtime_error with the cause when it cannot listen.
  HttpServer(const std::string& address, std::uint32_t port, HttpPage page);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  [[nodiscard]] std::uint32_t port() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace topogeo::service
