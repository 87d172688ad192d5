// main() of a fuzz target without libFuzzer: runs every file of a corpus, then deterministic mutations of them.
//   NAME_fuzz RUNS CORPUS [DICTIONARY]     RUNS: how many mutations
//   NAME_fuzz FILE                         one input
// The input that runs lies in NAME_fuzz.input beside the program for as long as it does: where the process ends in it, it
// stays.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kMostBytes = std::size_t{1} << 16;  // of an input: larger ones only take longer

[[noreturn]] void give_up(const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(2);
}

Bytes read(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) give_up("can't read " + file.string());
    return Bytes(std::istreambuf_iterator<char>(stream), {});
}

// The words of a dictionary of libFuzzer's: lines with a word between quotes, with \\, \" and \xNN; # comments.
std::vector<Bytes> words_of(const std::filesystem::path& file) {
    std::vector<Bytes> words;
    std::ifstream stream(file);
    if (!stream) give_up("can't read " + file.string());
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line[0] == '#') continue;
        const std::size_t first = line.find('"'), last = line.rfind('"');
        if (first == last) give_up(file.string() + ": no word in: " + line);
        Bytes word;
        for (std::size_t i = first + 1; i < last; ++i) {
            if (line[i] != '\\') {
                word.push_back(static_cast<std::uint8_t>(line[i]));
            } else if (line[++i] == 'x') {
                unsigned value = 0;
                std::from_chars(line.data() + i + 1, line.data() + i + 3, value, 16);
                word.push_back(static_cast<std::uint8_t>(value));
                i += 2;
            } else {
                word.push_back(static_cast<std::uint8_t>(line[i]));
            }
        }
        words.push_back(std::move(word));
    }
    return words;
}

// The input that runs, in a file's memory: there however the process ends.
class Kept {
  public:
    explicit Kept(std::filesystem::path file) : file_(std::move(file)) {
        descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0644);
        if (descriptor_ < 0 || ftruncate(descriptor_, kMostBytes) != 0)
            give_up("can't write " + file_.string());
        void* const at = mmap(nullptr, kMostBytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
        if (at == MAP_FAILED) give_up("can't map " + file_.string());
        memory_ = static_cast<std::uint8_t*>(at);
    }
    void run(const Bytes& input) {
        if (ftruncate(descriptor_, static_cast<off_t>(input.size())) != 0)
            give_up("can't write " + file_.string());
        std::copy(input.begin(), input.end(), memory_);
        // A copy of exactly its length: a sanitizer sees who reads beyond.
        const std::vector<std::uint8_t> exact(input);
        LLVMFuzzerTestOneInput(exact.data(), exact.size());
    }
    void remove() const { std::filesystem::remove(file_); }

  private:
    std::filesystem::path file_;
    int descriptor_ = -1;
    std::uint8_t* memory_ = nullptr;
};

// Not the library's distributions, which differ between libraries.
class Mutator {
  public:
    Mutator(const std::vector<Bytes>& corpus, const std::vector<Bytes>& words, std::uint64_t seed)
        : corpus_(corpus), words_(words), random_(seed) {}

    Bytes made() {
        Bytes bytes = corpus_[below(corpus_.size())];
        for (std::size_t changes = std::size_t{1} << below(4); changes > 0; --changes) change(bytes);
        if (bytes.size() > kMostBytes) bytes.resize(kMostBytes);
        return bytes;
    }

  private:
    std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }
    std::uint8_t any_byte() { return static_cast<std::uint8_t>(random_()); }
    static Bytes::iterator place(Bytes& bytes, std::size_t at) {
        return bytes.begin() + static_cast<std::ptrdiff_t>(at);
    }
    void put(Bytes& bytes, std::size_t at, const Bytes& piece, bool over) {
        if (over) bytes.erase(place(bytes, at), place(bytes, std::min(bytes.size(), at + piece.size())));
        bytes.insert(place(bytes, at), piece.begin(), piece.end());
    }

    void change(Bytes& bytes) {
        const std::size_t at = below(bytes.size() + 1);
        const std::size_t length = std::min(bytes.size() - at, std::size_t{1} << below(7));
        const Bytes piece(place(bytes, at), place(bytes, at + length));
        switch (below(8)) {
            case 0:  // a byte
                if (at < bytes.size()) bytes[at] = any_byte();
                break;
            case 1:  // a bit
                if (at < bytes.size()) bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
                break;
            case 2:  // new bytes
                put(bytes, at, Bytes(1 + below(8), any_byte()), false);
                break;
            case 3:  // less
                bytes.erase(place(bytes, at), place(bytes, at + length));
                break;
            case 4:  // a piece of its own, here or there once more
                put(bytes, below(bytes.size() + 1), piece, below(2) == 0);
                break;
            case 5: {  // a piece of another
                const Bytes& other = corpus_[below(corpus_.size())];
                const std::size_t from = below(other.size() + 1);
                const std::size_t count = std::min(other.size() - from, std::size_t{1} << below(10));
                const auto begin = other.begin() + static_cast<std::ptrdiff_t>(from);
                put(bytes, at, Bytes(begin, begin + static_cast<std::ptrdiff_t>(count)), below(2) == 0);
                break;
            }
            case 6:  // a number of two or four bytes at one of their edges
                for (std::size_t i = 0, count = std::size_t{2} << below(2);
                     i < count && at + i < bytes.size(); ++i)
                    bytes[at + i] = below(2) == 0 ? std::uint8_t{0xff} : std::uint8_t{0};
                break;
            default:
                if (!words_.empty()) put(bytes, at, words_[below(words_.size())], below(2) == 0);
                break;
        }
    }

    const std::vector<Bytes>&corpus_, &words_;
    std::mt19937_64 random_;
};

}  // namespace

int main(int argc, char** argv) {
    Kept kept(std::string(argv[0]) + ".input");
    if (argc == 2) {
        kept.run(read(argv[1]));
        kept.remove();
        return 0;
    }
    if (argc < 3 || argc > 4) give_up("NAME_fuzz RUNS CORPUS [DICTIONARY], or NAME_fuzz FILE");
    const std::size_t runs = std::strtoull(argv[1], nullptr, 10);
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[2])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Bytes> corpus;
    for (const std::filesystem::path& file : files) {
        corpus.push_back(read(file));
        if (corpus.back().size() > kMostBytes) give_up(file.string() + " is longer than 64 KiB");
    }
    if (corpus.empty()) give_up(std::string(argv[2]) + " is empty");
    const std::vector<Bytes> words = argc > 3 ? words_of(argv[3]) : std::vector<Bytes>();
    std::printf("the input that runs: %s.input\n", argv[0]);
    std::fflush(stdout);
    for (const Bytes& input : corpus) kept.run(input);
    for (std::size_t run = 0; run < runs; ++run) kept.run(Mutator(corpus, words, run).made());
    kept.remove();
    std::printf("%zu files, %zu mutations\n", corpus.size(), runs);
    return 0;
}
