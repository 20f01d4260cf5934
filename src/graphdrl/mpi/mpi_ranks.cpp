#include "graphdrl/mpi/mpi_ranks.h"

// C++ bindings would include more than C++20 allows.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <system_error>
#include <thread>

namespace graphdrl {
namespace {

using namespace std::chrono_literals;

constexpr int kQuickTests = 1000;              // some 100 us
constexpr std::int64_t kMostAtOnce = 1 << 30;  // bytes: MPI counts with int

// Pauses between looks at something: the longer it takes, the longer, so that at most some 2 % of the time is lost, and
// the processor is others'.
class Patience {
 public:
  void pause() const {
    const auto waited = std::chrono::steady_clock::now() - begin_;
    std::this_thread::sleep_for(std::clamp<std::chrono::nanoseconds>(waited / 50, 20us, 5ms));
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// MPI's own waiting takes a whole processor.
void wait(MPI_Request& request) {
  int done = 0;
  const Patience patience;
  for (int tests = 0;; ++tests) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    if (tests >= kQuickTests) patience.pause();
  }
}

// What all are there for: bytes flow only while MPI is asked.
void wait_at_work(MPI_Request& request) {
  int done = 0;
  while (true) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    std::this_thread::yield();
  }
}

constexpr int kAskTag = 1;
constexpr int kAnswerTag = 2;
constexpr int kNext = 1;
constexpr int kLeave = 2;
constexpr int kClose = 3;
constexpr int kNoMore = -1;

// Rank 0 hands out the tasks: to itself directly, to others on a thread of its own. MPI's communicator of queues is one
// that collective calls do not use.
class MpiTasks final : public TaskQueue {
 public:
  MpiTasks(int rank, int size, int count) : rank_(rank), size_(size), tasks_(one_rank().hand_out(count)) {
    MPI_Comm_dup(MPI_COMM_WORLD, &comm_);
    if (rank_ > 0) return;
    try {
      server_ = std::thread([this] { serve(); });
    } catch (const std::system_error& error) {
      refusal_ = error;
    }
  }
  MpiTasks(const MpiTasks&) = delete;

  ~MpiTasks() override {
    if (rank_ == 0) {
      if (server_.joinable()) server_.join();
    } else {
      say(kLeave);
    }
    MPI_Comm_free(&comm_);
  }

  // Why rank 0 hands out nothing.
  const std::optional<std::system_error>& refusal() const { return refusal_; }

  std::optional<int> next() override {
    if (rank_ == 0) return tasks_->next();
    const std::lock_guard lock(mutex_);
    if (exhausted_) return std::nullopt;
    int task = kNoMore;
    MPI_Request answer = MPI_REQUEST_NULL;
    MPI_Irecv(&task, 1, MPI_INT, 0, kAnswerTag, comm_, &answer);
    say(kNext);
    wait(answer);
    exhausted_ = task == kNoMore;
    return exhausted_ ? std::nullopt : std::optional(task);
  }

  void close() override {
    if (rank_ == 0) return tasks_->close();
    const std::lock_guard lock(mutex_);
    exhausted_ = true;
    say(kClose);
  }

 private:
  void say(const int& what) const {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Isend(&what, 1, MPI_INT, 0, kAskTag, comm_, &request);
    wait(request);
  }

  // Answers until every other rank has left.
  void serve() {
    Patience patience;
    for (int left = 0; left < size_ - 1;) {
      int there = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, kAskTag, comm_, &there, &status);
      if (there == 0) {
        patience.pause();
        continue;
      }
      patience = Patience();
      int asked = 0;
      MPI_Recv(&asked, 1, MPI_INT, status.MPI_SOURCE, kAskTag, comm_, MPI_STATUS_IGNORE);
      if (asked == kLeave) ++left;
      if (asked == kClose) tasks_->close();
      if (asked != kNext) continue;
      const int task = tasks_->next().value_or(kNoMore);
      MPI_Send(&task, 1, MPI_INT, status.MPI_SOURCE, kAnswerTag, comm_);
    }
  }

  int rank_;
  int size_;
  std::unique_ptr<TaskQueue> tasks_;  // rank 0's, as the next
  std::thread server_;
  std::optional<std::system_error> refusal_;
  MPI_Comm comm_ = MPI_COMM_NULL;
  std::mutex mutex_;  // of the others' questions
  bool exhausted_ = false;
};

}  // namespace

MpiRanks::MpiRanks(int& argc, char**& argv) {
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &provided);
  prctl(PR_SET_TIMERSLACK, 1);  // pauses of 20 us would take 70
  if (provided < MPI_THREAD_MULTIPLE) throw std::runtime_error("this MPI lets no two threads in at once");
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiRanks::~MpiRanks() {
  MPI_Finalize();
}

std::vector<MpiRanks::Header> MpiRanks::tell(const Header& own) {
  std::vector<Header> all(static_cast<std::size_t>(size_));
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&own, sizeof(Header), MPI_BYTE, all.data(), sizeof(Header), MPI_BYTE, MPI_COMM_WORLD, &request);
  wait(request);
  return all;
}

std::vector<MpiRanks::Header> MpiRanks::tell_all_at_work(const Header& own) {
  std::vector<Header> all = tell(own);
  for (int rank = 0; rank < size_; ++rank) {
    if (all[rank].call == Header::Call::kSettle) throw RankLost("rank " + std::to_string(rank) + " has left");
    if (all[rank].call != own.call) throw std::logic_error("ranks do different things at once");
  }
  return all;
}

// What all have told the length of. Long texts go in parts.
std::vector<std::string> MpiRanks::exchange(const std::vector<Header>& headers, const std::string& own) {
  std::vector<std::string> all(headers.size());
  std::int64_t longest = 0;
  for (std::size_t rank = 0; rank < headers.size(); ++rank) {
    all[rank].reserve(static_cast<std::size_t>(headers[rank].bytes));
    longest = std::max(longest, headers[rank].bytes);
  }
  const std::int64_t at_once = kMostAtOnce / size_;
  for (std::int64_t begin = 0; begin < longest; begin += at_once) {
    std::vector<int> counts(headers.size());
    std::vector<int> places(headers.size());
    int total = 0;
    for (std::size_t rank = 0; rank < headers.size(); ++rank) {
      counts[rank] = static_cast<int>(std::clamp<std::int64_t>(headers[rank].bytes - begin, 0, at_once));
      places[rank] = total;
      total += counts[rank];
    }
    std::string part(static_cast<std::size_t>(total), '\0');
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Iallgatherv(own.data() + std::min<std::int64_t>(begin, std::ssize(own)), counts[rank_], MPI_BYTE, part.data(),
                    counts.data(), places.data(), MPI_BYTE, MPI_COMM_WORLD, &request);
    wait_at_work(request);
    for (std::size_t rank = 0; rank < headers.size(); ++rank) {
      all[rank].append(part, static_cast<std::size_t>(places[rank]), static_cast<std::size_t>(counts[rank]));
    }
  }
  return all;
}

std::vector<std::string> MpiRanks::gather(const std::string& own) {
  return exchange(tell_all_at_work({Header::Call::kGather, 0, std::ssize(own)}), own);
}

bool MpiRanks::any(bool own) {
  const std::vector<Header> all = tell_all_at_work({Header::Call::kAny, own ? 1 : 0, 0});
  return std::ranges::any_of(all, [](const Header& header) { return header.flag != 0; });
}

std::unique_ptr<TaskQueue> MpiRanks::hand_out(int count) {
  if (alone()) return one_rank().hand_out(count);
  tell_all_at_work({Header::Call::kHandOut, 0, 0});  // MPI would wait for ever for a rank that has left
  auto tasks = std::make_unique<MpiTasks>(rank_, size_, count);
  if (any(tasks->refusal().has_value())) {
    if (tasks->refusal()) throw std::system_error(*tasks->refusal());
    throw RankLost("rank 0 hands out nothing");
  }
  return tasks;
}

std::vector<MpiRanks::Outcome> MpiRanks::settle(const Outcome& own) {
  std::vector<Header> all;
  const auto settles = [](const Header& header) { return header.call == Header::Call::kSettle; };
  do {
    all = tell({Header::Call::kSettle, own.status, std::ssize(own.complaint)});
  } while (!std::ranges::all_of(all, settles));
  std::vector<Outcome> outcomes;
  outcomes.reserve(all.size());
  const std::vector<std::string> complaints = exchange(all, own.complaint);
  for (int rank = 0; rank < size_; ++rank) outcomes.push_back({all[rank].flag, complaints[rank]});
  return outcomes;
}

}  // namespace graphdrl
