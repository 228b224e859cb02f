// Tests of one command of `topogeo`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "program.hpp"

namespace topogeo::test {

class CommandTest : public testing::Test {
 protected:
  explicit CommandTest(std::string command) : command_(std::move(command)) {}

  /// Runs `topogeo COMMAND WORDS...` and returns its exit code; its output is in out_ and err_.
  int run(std::vector<std::string> words) {
    words.insert(words.begin(), command_);
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out_ = program.out();
    err_ = program.err();
    return code;
  }

  std::string command_;
  Scratch scratch_;
  std::string out_;
  std::string err_;
};

}  // namespace topogeo::test
