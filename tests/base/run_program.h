// Runs a program as a person would and keeps what it said.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace isthmus::testing {

struct Said {
  int exit_code = -1;  ///< 128 + N if signal N ended it
  std::string out;
  std::string err;
};

inline std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A program that was started; standard output and error go to files in `folder`.
class StartedProgram {
 public:
  StartedProgram(const std::string& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& folder)
      : out_(folder / "said.out"), err_(folder / "said.err") {
    std::vector<std::string> words = {program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    std::filesystem::remove(out_);  // what an earlier program said is not to be taken for this one's
    std::filesystem::remove(err_);
    pid_ = ::fork();
    if (pid_ == 0) {
      redirect(out_, STDOUT_FILENO);
      redirect(err_, STDERR_FILENO);
      ::execv(program.c_str(), pointers.data());
      ::_exit(127);
    }
  }
  void signal(int number) const { ::kill(pid_, number); }
  [[nodiscard]] std::string err_so_far() const { return text_of_file(err_); }
  /// Whether the text appeared on standard error before the program ended or the time was over.
  [[nodiscard]] bool wait_for(const std::string& text, int seconds) const {
    for (int i = 0; i < seconds * 100; ++i) {
      if (err_so_far().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  Said finish() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, text_of_file(out_), text_of_file(err_)};
  }

 private:
  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t pid_ = -1;

  static void redirect(const std::filesystem::path& path, int to) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (fd >= 0) ::dup2(fd, to);
  }
};

inline Said run_program(const std::string& program, const std::vector<std::string>& arguments,
                        const std::filesystem::path& folder) {
  return StartedProgram(program, arguments, folder).finish();
}

}  // namespace isthmus::testing
