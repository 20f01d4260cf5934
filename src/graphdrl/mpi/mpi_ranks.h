// Ranks by MPI: the processes of one mpirun, or this one alone where it was started without.
#pragma once

#include "graphdrl/base/ranks.h"

namespace graphdrl {

class MpiRanks final : public Ranks {
 public:
  // Begins MPI. One object a process. Throws std::runtime_error where MPI lets no two threads in.
  MpiRanks(int& argc, char**& argv);
  MpiRanks(const MpiRanks&) = delete;
  // Ends MPI. REQUIRES: settle() was called.
  ~MpiRanks() override;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<std::string> gather(const std::string& own) override;
  bool any(bool own) override;
  std::unique_ptr<TaskQueue> hand_out(int count) override;

  // What became of a rank.
  struct Outcome {
    int status = 0;
    std::string complaint = {};
  };
  // The last word of every rank, however its work ended: gives all of them, by rank. Ranks that still wait for this one
  // in a collective call throw RankLost there.
  std::vector<Outcome> settle(const Outcome& own);

 private:
  // What a rank is about to do, told before every collective call.
  struct Header {
    enum class Call : int { kGather, kAny, kHandOut, kSettle };
    Call call;
    int flag;
    std::int64_t bytes;
  };
  std::vector<Header> tell(const Header& own);
  std::vector<Header> tell_all_at_work(const Header& own);
  std::vector<std::string> exchange(const std::vector<Header>& headers, const std::string& own);

  int rank_ = 0;
  int size_ = 1;
};

}  // namespace graphdrl
