#include "recording/file_hash.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>

#include "failure/failure.h"

namespace abbe::recording {
namespace {

class Sha256 {
 public:
  Sha256() : hash_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(hash_.get(), EVP_sha256(), nullptr);
  }
  void Add(const char* data, std::size_t size) { EVP_DigestUpdate(hash_.get(), data, size); }
  std::string Digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(hash_.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> hash_;
};

}  // namespace

std::string Sha256OfFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Sha256 hash;
  std::array<char, 1 << 16> block;
  while (file.read(block.data(), block.size()) || file.gcount() > 0) {
    hash.Add(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) {
    throw InputError(fmt::format("{}: cannot be read; check the path", path.string()));
  }
  return hash.Digits();
}

std::string Sha256OfText(std::string_view text) {
  Sha256 hash;
  hash.Add(text.data(), text.size());
  return hash.Digits();
}

}  // namespace abbe::recording
