// Runs the real program. See program.h.
#include "tests/plugin/host/cli/program.h"

#include <OpenEXR/ImfCheckFile.h>
#include <fcntl.h>
#include <pty.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/plugin/bake/read_vdb.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what) {
    throw std::runtime_error(what + ": " + std::strerror(errno));
}

std::string read_all(int descriptor) {
    std::string text;
    char buffer[4096];
    off_t at = 0;
    for (ssize_t n; (n = pread(descriptor, buffer, sizeof buffer, at)) > 0; at += n)
        text.append(buffer, static_cast<std::size_t>(n));
    return text;
}

// Does only what is allowed between fork() and exec().
[[noreturn]] void become(const Launch& launch, char* const* arguments, int out, int err) {
    for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal, SIG_DFL);
    if (launch.ignore_interrupt) ::signal(SIGINT, SIG_IGN);
    if (launch.most_address_space > 0) {
        const rlimit limit{launch.most_address_space, launch.most_address_space};
        if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(126);
    }
    if (chdir(launch.folder.c_str()) != 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0)
        _exit(126);
    execv(launch.program.c_str(), arguments);
    _exit(127);
}

std::string why_torn_usd(const std::string& text) {
    if (!text.starts_with("#usda 1.0\n")) return "does not begin with #usda 1.0";
    std::string open;
    bool in_string = false, in_comment = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_comment) {
            in_comment = c != '\n';
        } else if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '#') {
            in_comment = true;
        } else if (c == '(' || c == '[' || c == '{') {
            open += c == '(' ? ')' : c == '[' ? ']' : '}';
        } else if (c == ')' || c == ']' || c == '}') {
            if (open.empty() || open.back() != c) return "has a bracket too many";
            open.pop_back();
        }
    }
    if (in_string || !open.empty()) return "ends in the middle";
    if (!text.ends_with("}\n")) return "does not end with a closed prim";
    return {};
}

// The format: "PXR-USDC", at byte 16 where the table of contents is, and the table at the file's end: the
// number of sections, then for each 16 bytes of name, where it begins and how long it is.
std::string why_torn_crate(const std::string& bytes) {
    if (!bytes.starts_with("PXR-USDC")) return "does not begin with PXR-USDC";
    const auto number_at = [&](std::size_t at) {
        std::uint64_t number = 0;
        if (at + sizeof number <= bytes.size()) std::memcpy(&number, bytes.data() + at, sizeof number);
        return number;
    };
    constexpr std::size_t kSectionBytes = 32;
    const std::uint64_t contents = number_at(16), sections = number_at(contents);
    if (sections == 0 || contents + 8 + kSectionBytes * sections != bytes.size())
        return "does not end with its contents";
    const std::size_t last = bytes.size() - kSectionBytes;
    return number_at(last + 16) + number_at(last + 24) == contents ? "" : "has sections of other lengths";
}

// The format: eight bytes, then chunks of length, name, content and checksum; the last one is IEND.
std::string why_torn_png(const std::string& bytes) {
    if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) return "does not begin as a PNG";
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        std::size_t length = 0;
        for (std::size_t i = at; i < at + 4; ++i) length = length << 8 | static_cast<unsigned char>(bytes[i]);
        const bool is_last = bytes.compare(at + 4, 4, "IEND") == 0;
        at += 12 + length;
        if (is_last) return at == bytes.size() ? "" : "has more after its end";
    }
    return "ends in the middle";
}

// OpenVDB reads all of it.
std::string why_torn_vdb(const fs::path& file) {
    try {
        return read_vdb(file).empty() ? "holds no grid" : "";
    } catch (const std::exception& error) {
        return error.what();
    }
}

std::string why_torn(const fs::path& file) {
    const std::string extension = file.extension();
    if (extension == ".usda") return why_torn_usd(read_file(file));
    if (extension == ".usdc") return why_torn_crate(read_file(file));
    if (extension == ".json") return nlohmann::json::accept(read_file(file)) ? "" : "is not JSON";
    if (extension == ".exr") return Imf::checkOpenEXRFile(file.c_str()) ? "is not a whole OpenEXR file" : "";
    if (extension == ".png") return why_torn_png(read_file(file));
    if (extension == ".vdb") return why_torn_vdb(file);
    if (extension == ".toml") return {};  // written by the test
    return "is of an unknown kind";
}

bool is_hidden(const fs::path& file) {
    return file.filename().string().starts_with('.');
}

// Enters a private mount namespace, as root, or else as root of a new user namespace.
std::string private_mounts() {
    static const std::string problem = [] {
        const std::string user = std::to_string(getuid()), group = std::to_string(getgid());
        if (unshare(CLONE_NEWNS) != 0) {
            if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
                return std::string("no mount namespace: ") + std::strerror(errno);
            write_file("/proc/self/setgroups", "deny");
            write_file("/proc/self/uid_map", "0 " + user + " 1");
            write_file("/proc/self/gid_map", "0 " + group + " 1");
        }
        if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
            return std::string("mounts can't be made private: ") + std::strerror(errno);
        return std::string();
    }();
    return problem;
}

}  // namespace

TempFolder::TempFolder() {
    std::string name = (fs::temp_directory_path() / "pelagic-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) fail("mkdtemp");
    path_ = name;
}

TempFolder::~TempFolder() {
    while (umount2(path_.c_str(), MNT_DETACH) == 0) {
    }
    for (const auto& entry : fs::directory_iterator(path_)) umount2(entry.path().c_str(), MNT_DETACH);
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

Running::Running(const Launch& launch)
    : out_is_captured_(launch.stdout_to.empty()), start_(std::chrono::steady_clock::now()) {
    std::vector<std::string> words{launch.program.string()};
    words.insert(words.end(), launch.arguments.begin(), launch.arguments.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);

    out_ = launch.stdout_to.empty() ? memfd_create("stdout", MFD_CLOEXEC)
                                    : open(launch.stdout_to.c_str(), O_RDWR | O_CLOEXEC);
    err_ = memfd_create("stderr", MFD_CLOEXEC);
    if (out_ < 0 || err_ < 0) fail("a file for the output");
    int err = err_;
    if (launch.terminal) {
        winsize size{};
        size.ws_row = 25;
        size.ws_col = 80;
        if (openpty(&terminal_, &err, nullptr, nullptr, &size) != 0) fail("openpty");
        fcntl(terminal_, F_SETFD, FD_CLOEXEC);
        setenv("TERM", "xterm", 1);
    }
    process_ = fork();
    if (process_ < 0) fail("fork");
    if (process_ == 0) become(launch, arguments.data(), out_, err);
    if (launch.terminal) close(err);
}

Running::~Running() {
    if (!ended_) {
        kill(process_, SIGKILL);
        reap(true);
    }
    for (int descriptor : {out_, err_, terminal_})
        if (descriptor >= 0) close(descriptor);
}

void Running::send(int signal) {
    if (!has_ended()) kill(process_, signal);
}

void Running::reap(bool block) {
    if (ended_) return;
    pid_t got = 0;
    rusage usage{};
    do got = wait4(process_, &wait_status_, block ? 0 : WNOHANG, &usage);
    while (got < 0 && errno == EINTR);
    ended_ = got == process_;
    for (const timeval& used : {usage.ru_utime, usage.ru_stime})
        cpu_s_ += static_cast<double>(used.tv_sec) + 1e-6 * static_cast<double>(used.tv_usec);
}

bool Running::has_ended() {
    reap(false);
    return ended_;
}

std::string Running::messages() const {
    return read_all(err_);
}

Ended Running::wait() {
    Ended ended;
    char buffer[4096];
    // Reads the terminal until its other end is closed everywhere.
    for (ssize_t n; terminal_ >= 0 && (n = read(terminal_, buffer, sizeof buffer)) > 0;)
        ended.err.append(buffer, static_cast<std::size_t>(n));
    reap(true);
    ended.killed = WIFSIGNALED(wait_status_);
    ended.status = ended.killed ? 128 + WTERMSIG(wait_status_) : WEXITSTATUS(wait_status_);
    if (out_is_captured_) ended.out = read_all(out_);
    if (terminal_ < 0) ended.err = read_all(err_);
    ended.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    ended.cpu_s = cpu_s_;
    return ended;
}

Ended run(const Launch& launch) {
    return Running(launch).wait();
}

void write_file(const fs::path& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::map<std::string, std::string> files_below(const fs::path& folder) {
    std::map<std::string, std::string> files;
    if (!fs::exists(folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
    return files;
}

std::string torn_files(const fs::path& folder) {
    std::string problems;
    if (!fs::exists(folder)) return problems;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file() || is_hidden(entry.path())) continue;
        const std::string why = why_torn(entry.path());
        if (!why.empty()) problems += entry.path().string() + ' ' + why + '\n';
    }
    return problems;
}

std::vector<std::string> leftovers(const fs::path& folder) {
    std::vector<std::string> hidden;
    for (const auto& [path, bytes] : files_below(folder))
        if (is_hidden(path)) hidden.push_back(path);
    return hidden;
}

std::string differences(const fs::path& a, const fs::path& b) {
    const auto in_a = files_below(a), in_b = files_below(b);
    std::string text;
    for (const auto& [path, bytes] : in_a) {
        const auto other = in_b.find(path);
        if (other == in_b.end()) text += path + " is only in " + a.string() + '\n';
        if (other != in_b.end() && other->second != bytes) text += path + " differs\n";
    }
    for (const auto& [path, bytes] : in_b)
        if (!in_a.contains(path)) text += path + " is only in " + b.string() + '\n';
    return text;
}

std::string mount_disk(const MemoryDisk& disk) {
    if (const std::string problem = private_mounts(); !problem.empty()) return problem;
    const unsigned long flags = (disk.read_only ? +MS_RDONLY : 0) | (disk.again ? +MS_REMOUNT : 0);
    if (mount("none", disk.folder.c_str(), "tmpfs", flags, ("size=" + disk.size).c_str()) != 0)
        return std::string("no tmpfs: ") + std::strerror(errno);
    return {};
}

}  // namespace pelagic::test
