#include "topogeo/command_line/secret_arguments.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::command_line {
namespace {

using testing::ElementsAre;

/// The kernel's view of a program's arguments.
class Kernel {
 public:
  explicit Kernel(std::vector<std::string> words) : words_(std::move(words)) {
    for (std::string& word : words_) pointers_.push_back(word.data());
  }
  SecretArguments take() {
    return {static_cast<int>(pointers_.size()), pointers_.data(), {"--token", "--password"}};
  }
  [[nodiscard]] const std::vector<std::string>& shown() const { return words_; }

 private:
  std::vector<std::string> words_;
  std::vector<char*> pointers_;
};

std::vector<std::string> texts(const SecretArguments& arguments) {
  return {arguments.values(), arguments.values() + arguments.count()};
}

TEST(SecretArguments, AreForTheProgramAlone) {
  Kernel kernel({"web", "--token", "secret", "--port", "0", "--password=word"});
  const SecretArguments arguments = kernel.take();
  EXPECT_THAT(texts(arguments),
              ElementsAre("web", "--token", "secret", "--port", "0", "--password=word"));
  EXPECT_EQ(arguments.values()[arguments.count()], nullptr);
  EXPECT_THAT(kernel.shown(),
              ElementsAre("web", "--token", "xxxxxx", "--port", "0", "--password=xxxx"));
  EXPECT_TRUE(arguments.had_secret());
}

TEST(SecretArguments, AreNotFilesWithSecrets) {
  Kernel kernel({"web", "--token-file", "secret", "token"});
  const SecretArguments arguments = kernel.take();
  EXPECT_THAT(kernel.shown(), ElementsAre("web", "--token-file", "secret", "token"));
  EXPECT_FALSE(arguments.had_secret());
}

TEST(SecretArguments, MayLackTheirValue) {
  Kernel kernel({"web", "--token"});
  const SecretArguments arguments = kernel.take();
  EXPECT_THAT(texts(arguments), ElementsAre("web", "--token"));
  EXPECT_FALSE(arguments.had_secret());
}

}  // namespace
}  // namespace topogeo::command_line
